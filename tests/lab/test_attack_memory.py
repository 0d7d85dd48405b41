"""What the soak calls growth: not pictures that are in use, nor memory that is kept for later."""

from __future__ import annotations

import gc

import pytest
from support.renderers import need_opengl
from support.rigs import ball

from faceedit_app.lab.attacks import memory
from faceedit_app.render import contexts, default_camera, open_renderer


def test_all_that_pictures_were_drawn_in_is_freed(monkeypatch: pytest.MonkeyPatch) -> None:
    need_opengl()
    assert contexts.drawn_by()
    monkeypatch.setattr(memory, "_draws_in_software", lambda: True)
    gc.collect()  # of other tests
    before, rig = memory.framebuffers(), ball()
    renderer = open_renderer(rig, 8, 8)
    camera = default_camera(rig, 1.0)
    taken = []
    for size in (96, 32, 64, 96):
        renderer.resize(size, size)
        for smooth in (True, False, False):
            renderer.draw(rig.neutral, camera, smooth)
            renderer.prepare()
        taken.append(memory.framebuffers() - before)
    # Twice four samples of a picture of twice the size, two with one, and one to halve it in.
    assert taken == [size**2 * 8 * (2 * 4 * 4 + 2 + 4) for size in (96, 32, 64, 96)]
    renderer.close()
    assert memory.framebuffers() == before


def test_what_pythons_allocator_keeps_for_later_is_left_out() -> None:
    before = memory.kept_by_python()
    if not before:
        pytest.skip("this Python does not say what its allocator keeps")
    many = [float(number) for number in range(400_000)]
    in_use = memory.kept_by_python()
    assert in_use - before < 2 * 2**20, "objects in use are not left out"
    few = many[::500]  # spread over all that was allocated
    del many
    assert memory.kept_by_python() - in_use > 8 * 2**20
    assert len(few) == 800


def test_pictures_that_a_graphics_card_keeps_are_not_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name, in_software in (("llvmpipe (LLVM 15.0.7, 256 bits)", True), ("NVIDIA H100", False)):
        monkeypatch.setattr(contexts, "drawn_by", lambda name=name: name)
        memory._draws_in_software.cache_clear()
        assert memory._draws_in_software() is in_software
    memory._draws_in_software.cache_clear()
