"""What drawing imports: pyrender's modules that draw, whole, and nothing that it has for others."""

from __future__ import annotations

import subprocess
import sys

from support.places import ROOT


def test_drawing_imports_no_viewer_and_no_readers_of_meshes() -> None:
    """They would take a third of the time until the face is there, and 60 MB."""
    code = """
import sys
from faceedit_app.ui.state.loading import prepare_renderer
prepare_renderer()
assert "faceedit_app.render.studio" in sys.modules, "not prepared"
heavy = {"pyglet", "imageio", "tkinter", "trimesh", "networkx", "torch", "scipy.spatial"}
print(sorted(heavy & set(sys.modules)))
# What pyrender and trimesh have for others is there for whoever imports them.
import numpy, pyrender, trimesh
assert numpy.testing.assert_allclose
assert pyrender.Viewer and trimesh.Trimesh
"""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"
