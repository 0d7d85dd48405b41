"""What the soak calls growth: not pictures that are in use, nor memory that is kept for later."""

from __future__ import annotations

import ctypes
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


def test_what_cs_allocator_keeps_for_later_is_left_out() -> None:
    if not memory.kept_by_c():
        pytest.skip("this C library does not say what its allocator keeps")
    libc = ctypes.CDLL(None)
    libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    libc.free.restype, libc.free.argtypes = None, [ctypes.c_void_p]
    before = memory.kept_by_c()
    many = [libc.malloc(1_500) for _ in range(20_000)]  # less than a page each: none is unmapped
    for one in many:
        ctypes.memset(one, 1, 1_500)
    in_use = memory.kept_by_c()
    assert in_use - before < 4 * 2**20, "what is in use is not left out"
    kept = many[::2]
    for one in many[1::2]:
        libc.free(one)
    libc.malloc_trim(0)
    assert memory.kept_by_c() - in_use > 8 * 2**20
    for one in kept:
        libc.free(one)


def test_the_heaps_of_all_threads_are_counted_and_nothing_else() -> None:
    smaps = """\
55d000000000-55d000400000 rw-p 00000000 00:00 0                          [heap]
Anonymous:          1000 kB
7f0004000000-7f0004200000 rw-p 00000000 00:00 0
Anonymous:           200 kB
7f0004200000-7f0004800000 rw-p 00000000 00:00 0
Anonymous:            30 kB
7f0004800000-7f0008000000 ---p 00000000 00:00 0
Anonymous:             0 kB
7f0009000000-7f0009200000 rw-p 00000000 00:00 0
Anonymous:          4000 kB
7f000c000000-7f000c200000 rw-p 00000000 fe:01 1234                       /usr/lib/libQt6Gui.so
Anonymous:           800 kB
"""
    assert memory._heaps(smaps.splitlines()) == 1_230 * 2**10


def test_pictures_that_a_graphics_card_keeps_are_not_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name, in_software in (("llvmpipe (LLVM 15.0.7, 256 bits)", True), ("NVIDIA H100", False)):
        monkeypatch.setattr(contexts, "drawn_by", lambda name=name: name)
        memory._draws_in_software.cache_clear()
        assert memory._draws_in_software() is in_software
    memory._draws_in_software.cache_clear()
