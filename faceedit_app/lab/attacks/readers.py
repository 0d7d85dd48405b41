"""Every reader of the application, with a valid file that it reads."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

from faceedit_app.characters.registry import read_character
from faceedit_app.characters.scans import read_scan
from faceedit_app.editing.files.project import read_project
from faceedit_app.formats.registry import endings
from faceedit_app.lab.attacks.reader import Reader, reader_of
from faceedit_app.lab.attacks.valid_characters import character_readers
from faceedit_app.lab.attacks.valid_documents import document_readers, read_journal
from faceedit_app.lab.attacks.valid_media import media_readers, model_readers, read_film
from faceedit_app.lab.attacks.valid_packets import packet_readers
from faceedit_app.lab.attacks.valid_takes import read_take, take_readers
from faceedit_app.lab.attacks.valid_words import word_readers
from faceedit_app.media import FILM_ENDINGS, SOUND_ENDINGS
from faceedit_app.media.sound import read_sound
from faceedit_app.networks.region import read_region

_BY_ENDING: tuple[tuple[str, tuple[str, ...], Callable[[Path], object]], ...] = (
    ("takes", endings(), read_take),
    ("projects", (".faceedit",), read_project),
    ("journals", (".jsonl",), read_journal),
    ("characters", (".glb", ".gltf", ".vrm", ".fbx", ".obj"), read_character),
    ("scans", (".glb", ".obj", ".ply", ".stl"), read_scan),
    ("sounds", (*SOUND_ENDINGS, *FILM_ENDINGS), read_sound),
    ("films", FILM_ENDINGS, read_film),
    ("models", (".onnx",), read_region),
)


def all_readers(folder: Path) -> list[Reader]:
    """Every reader, once for each of its valid files.

    Args:
        folder: where the valid files are made.
    """
    readers = [
        *take_readers(),
        *document_readers(folder),
        *word_readers(folder),
        *character_readers(folder),
        *media_readers(folder),
        *model_readers(),
        *packet_readers(),
    ]
    if find_spec("PySide6") is not None:  # a server has no Qt, and reads everything else
        from faceedit_app.lab.attacks.valid_settings import setting_readers

        readers += setting_readers()
    return readers


def readers_of(sample: Path) -> list[Reader]:
    """The readers of a user's own valid file, by its ending."""
    ending = sample.suffix.lower()
    return [reader_of(name, sample, read) for name, known, read in _BY_ENDING if ending in known]
