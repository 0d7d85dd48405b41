"""Which files a file dialog offers: names and file name patterns, in Qt's form."""

from __future__ import annotations

from collections.abc import Iterable

from faceedit_app.editing.files import PROJECT_SUFFIX
from faceedit_app.media import ENDINGS, FILM_ENDINGS

_SCAN_ENDINGS = (".obj", ".ply", ".stl", ".glb", ".gltf")
_ALL = "All files (*)"


def _patterns(endings: Iterable[str]) -> str:
    return " ".join(f"*{ending} *{ending.upper()}" for ending in endings)


PROJECTS = f"Projects (*{PROJECT_SUFFIX});;{_ALL}"
MEDIA = f"Sound and film ({_patterns(ENDINGS)});;{_ALL}"
FILMS = f"Films ({_patterns(FILM_ENDINGS)});;{_ALL}"
MP4 = f"Films (*.mp4);;{_ALL}"
_WORDS = "*.TextGrid *.textgrid *.srt *.vtt *.json *.txt"
WORDS = f"Words ({_WORDS});;{_ALL}"
SOUND_OR_WORDS = f"Sound and words ({_patterns(ENDINGS)} {_WORDS});;{_ALL}"
WRITTEN_WORDS = "TextGrid (*.TextGrid);;Subtitles (*.srt);;JSON (*.json)"
EDITS = f"Edits (*.json);;{_ALL}"
PICTURES = f"Pictures (*.png);;{_ALL}"
RECORDINGS = f"Takes (*.csv);;{_ALL}"
TRACKED_TAKES = f"Live Link Face CSV (*.csv);;{_ALL}"
SCANS = f"Scans ({_patterns(_SCAN_ENDINGS)});;{_ALL}"
WRITTEN_CHARACTERS = f"Characters (*.glb);;{_ALL}"


def takes_pattern() -> str:
    """Patterns of all take formats."""
    from faceedit_app.formats.registry import endings  # not needed before the window is up

    return _patterns(endings())


def takes() -> str:
    """Takes of all formats."""
    return f"Takes ({takes_pattern()});;{_ALL}"


def all_that_opens() -> str:
    """What Open accepts: takes, projects and kept copies of them, and films, which are tracked."""
    films, projects = _patterns(FILM_ENDINGS), f"*{PROJECT_SUFFIX} *{PROJECT_SUFFIX}.bak*"
    return f"Takes, projects and films ({takes_pattern()} {projects} {films});;{_ALL}"


def characters() -> str:
    """Characters of all formats."""
    from faceedit_app.characters.registry import FORMATS  # not needed before the window is up

    return f"Characters ({_patterns(e for kind in FORMATS for e in kind.endings)});;{_ALL}"


def like(ending: str) -> str:
    """Files with one ending; "" = folders."""
    return f"{ending.removeprefix('.').upper() or 'Folders'} (*{ending});;{_ALL}"
