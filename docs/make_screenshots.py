"""Writes the pictures of README.md and of guide, film and words in docs, and docs/shortcuts.md.

    python docs/make_screenshots.py

They are taken from the real window, which is driven as a user would. Needs no display: it is drawn
offscreen, on the demo take, and on a film of the character.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import groupby
from pathlib import Path
from unittest.mock import patch

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import numpy as np
from PIL import Image
from PySide6.QtCore import QPoint, QPointF, QSettings, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from faceedit_app.core.arrays import Pixels
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, MOUTH_WIDTH
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files import journal
from faceedit_app.editing.opening import shipped_rig
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.evaluation.film_file import write_film
from faceedit_app.lab.training import demo_take
from faceedit_app.lab.training.phonemes import PAUSE, parse
from faceedit_app.media.film import Film as OpenFilm
from faceedit_app.render import Camera, default_camera
from faceedit_app.render.renderer import open_renderer
from faceedit_app.render.snapshot import snapshot
from faceedit_app.tracking.side_by_side import SideBySide, write_side_by_side
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.menus import help_rows
from faceedit_app.ui.media.tracking_dialog import TrackingDialog
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.application import application
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences
from faceedit_app.words.dictionary import tokens
from faceedit_app.words.transcript import Phoneme, Transcript, Word

DOCS = Path(__file__).parent
PICTURES = DOCS / "images"
SIZE = (1440, 900)
LEFT = Qt.MouseButton.LeftButton
FILM_SIZE = (1080, 660)  # of the window
FILM_WIDTH = 900  # pixels
FRAME_MS = 80
CLOSE_UP = 300  # pixels
FILM_RATE, PICTURES_OF_FILM = 25.0, 75
CUP = range(44, 54)  # pictures that show it
POINTER = ((0, 0), (0, 18), (4, 14), (7, 20), (10, 19), (7, 13), (12, 13))


def main() -> None:
    """Walk through the guide."""
    PICTURES.mkdir(exist_ok=True)
    (DOCS / "shortcuts.md").write_text(shortcuts(), encoding="utf-8")
    close_ups(shipped_rig()).save(PICTURES / "character.webp", quality=82)
    application()
    with (
        tempfile.TemporaryDirectory() as folder,
        # Otherwise a window would ask about edits of the user's that a crash has left.
        patch.object(journal, "journal_folder", lambda: Path(folder) / "journals"),
    ):
        settings = QSettings(str(Path(folder) / "s.ini"), QSettings.Format.IniFormat)
        window = MainWindow(Preferences(settings))
        window.resize(*SIZE)
        window.show()
        picture(window, "guide_start")
        window.open_demo_now()
        walk(window)
        speak(window)
        window.leave()
        film = MainWindow(Preferences(settings))
        film.resize(*FILM_SIZE)
        film.show()
        film.open_demo_now()
        Film(film).shoot("drag")
        film.leave()
        experienced = Preferences(settings)
        experienced.set_hints_seen()
        tracked = MainWindow(experienced)
        tracked.resize(*SIZE)
        tracked.show()
        tracked.start(None)
        track(tracked, Path(folder))
        tracked.leave()


def close_ups(rig: Rig) -> Image.Image:
    """A row of pictures in which a character's flaws show first."""
    eye = _middle(rig, LIDS[0])
    mouth = _middle(rig, MOUTH_WIDTH)
    brow = (eye[0] / 2, float(rig.neutral[:, 1].max()) - 0.05, eye[2])
    pictures: tuple[tuple[Camera, dict[str, float]], ...] = (
        (default_camera(rig).orbit(0.6, 0.1).zoom(0.85), {}),
        (Camera(0.25, 0.2, 0.34, brow), {}),
        (Camera(distance=0.15, target=eye), {}),
        (Camera(distance=0.15, target=eye), {"eyeBlink": 0.5}),
        (Camera(distance=0.24, target=mouth), {"mouthUpperUp": 1.0, "mouthLowerDown": 1.0}),
        (Camera(0.3, 0.1, 0.28, mouth), {"jawOpen": 0.9}),
    )
    row = Image.new("RGB", (CLOSE_UP * len(pictures), CLOSE_UP))
    for i, (camera, shapes) in enumerate(pictures):
        weights = [
            next((shapes[stem] for stem in shapes if name.startswith(stem)), 0.0)
            for name in rig.channels
        ]
        image = snapshot(rig, np.array(weights, np.float32), CLOSE_UP, CLOSE_UP, camera)
        row.paste(Image.fromarray(image), (i * CLOSE_UP, 0))
    return row


def _middle(rig: Rig, control: str) -> tuple[float, float, float]:
    x, y, z = rig.neutral[rig.control_pairs[CONTROL_INDEX[control]]].mean(axis=0).tolist()
    return x, y, z


def walk(window: MainWindow) -> None:
    """From opening a take to exporting it."""
    editor, line = window.editor, window.timeline
    assert editor is not None
    wait(0.6)  # problems are searched
    picture(window, "guide_open")
    do(window, "first_steps")
    picture(window, "guide_steps")
    do(window, "deselect")

    line.show_range(4.6, 8.2)
    opening, at = editor.curves.plots[0].viewport(), place(editor, 6.1, 40)
    drag(opening, at, QPoint(0, -16), release=False)
    picture(window, "guide_drag")
    QTest.mouseRelease(opening, LEFT, pos=at + QPoint(0, -16))
    QTest.mouseMove(editor.face, QPoint(40, 200))

    line.select((6.2, 6.8))
    line.set_falloffs(0.2, 0.35)
    line.go_to_time(6.4)
    picture(window, "guide_selection")

    line.show_range(0.0, line.duration)
    line.select(None)
    go_to(window, editor, "blink")
    do(window, "fix_problem")
    picture(window, "guide_blink")
    do(window, "accept_fix")
    go_to(window, editor, "lips")
    do(window, "fix_problem")
    picture(window, "guide_lips")
    do(window, "accept_fix")

    line.go_to_time(5.2)
    do(window, "fix_smile")
    editor.edits.strength.setValue(70)
    editor.edits.settle()
    do(window, "show_both")
    picture(window, "guide_smile")
    do(window, "show_difference")
    picture(window, "guide_difference")
    do(window, "show_difference")
    do(window, "show_edited")


def speak(window: MainWindow) -> None:
    """The demo take again, with what it says."""
    window.open_demo_now()
    editor, session = window.editor, window.document.session
    assert editor is not None
    assert session is not None
    session.say(demo_words())
    wait(0.6)  # problems are searched
    go_to(window, editor, "lips")
    do(window, "fix_problem")
    picture(window, "words")
    do(window, "deselect")


def demo_words() -> Transcript:
    """What the demo take says, as it was synthesised."""
    script = demo_take.script()
    symbols = [phoneme.symbol for phoneme in script.phonemes]
    texts = tokens(" ".join(demo_take.SENTENCES))
    words, at = list[Word](), 0
    for text, said in zip(texts, " ".join(demo_take.TRANSCRIPTIONS).split(), strict=True):
        while symbols[at] == PAUSE:
            at += 1
        until = at + len(parse(said))
        parts = tuple(Phoneme(symbols[i], *script.span(i)) for i in range(at, until))
        words.append(Word(text, parts[0].start, parts[-1].end, parts))
        at = until
    return Transcript(tuple(words))


def track(window: MainWindow, folder: Path) -> None:
    """From a film to a take, and to film and faces side by side."""
    film, take = folder / "performance.mp4", folder / "performance.csv"
    rig = shipped_rig()
    write_film(film, performance(rig), np.arange(PICTURES_OF_FILM) / FILM_RATE, FILM_RATE)
    with patch.object(dialogs, "ask_save_take", return_value=take):
        window.commands.file.track(film)
    dialog = window.findChildren(TrackingDialog)[-1]
    wait_until(lambda: dialog.bar.value() > PICTURES_OF_FILM // 2)
    dialog.grab().save(str(PICTURES / "film_tracking.png"))
    wait_until(lambda: window.media.film is not None and window.media.overlay.stored is not None)
    editor, line = window.editor, window.timeline
    assert editor is not None
    session = window.document.session
    assert session is not None
    wait_until(lambda: editor.face.viewport.draws > 0)
    line.go_to_time(0.9)
    editor.problems.search()
    picture(window, "film_open")
    session.add(Edit((MOUTH_WIDTH,), Op.OFFSET, 0.2, 2.6, 0.3, 9.0))
    stored, pictures = window.media.overlay.stored, window.media.film
    assert stored is not None
    assert pictures is not None
    shown = SideBySide.of_take(
        OpenFilm(film), stored, session.take.clip, session.edited_clip(), pictures.offset
    )
    write_side_by_side(folder / "both.mp4", shown, rig)
    both = Image.open(folder / "both.png")
    both.resize((900, round(900 * both.height / both.width)), Image.Resampling.LANCZOS).save(
        PICTURES / "film_side_by_side.webp", quality=82
    )


def performance(rig: Rig) -> Iterator[Pixels]:
    """Pictures of the character playing the demo take, with a cup before its mouth for a moment."""
    clip = open_take(shipped(DEMO_TAKE)).clip
    weights = clip.arkit_weights()
    renderer = open_renderer(rig, 640, 640)
    down, across = np.mgrid[:640, :640]
    cup = np.hypot((across - 320) / 90, (down - 430) / 110)[..., None]
    try:
        for number in range(PICTURES_OF_FILM):
            frame = clip.frame_at(4.0 + number / FILM_RATE)
            vertices = rig.vertices(rig.from_arkit(weights[frame]))
            drawn = renderer.draw(vertices, default_camera(rig))[..., 2::-1]
            if number in CUP:
                drawn = np.where(cup < 1, np.array([70, 96, 120]) * (1.3 - 0.5 * cup), drawn)
            yield drawn.astype(np.uint8)
    finally:
        renderer.close()


class Film:
    """A film of one drag: the window with a pointer, frame by frame."""

    def __init__(self, window: MainWindow) -> None:
        self._window, self._frames = window, list[Image.Image]()
        self._pointer = QPointF(0.62 * FILM_SIZE[0], 0.7 * FILM_SIZE[1])
        self._lasts = list[int]()

    def shoot(self, name: str) -> None:
        """Press on a curve, drag it up and partly back, release it, and undo."""
        window, editor = self._window, self._window.editor
        assert editor is not None
        wait(0.6)  # problems are searched
        window.timeline.show_range(4.2, 8.0)
        window.timeline.set_falloffs(0.25, 0.25)
        window.timeline.go_to_time(5.02)
        wait(0.5)  # the face is drawn finely
        plot = editor.curves.plots[0].viewport()
        start = place(editor, 5.02, 0.55 * plot.height())
        self._frame(400)
        for share in (0.3, 0.6, 0.85, 1.0):
            self._go(plot, start, share)
        QTest.mousePress(plot, LEFT, pos=start)
        heights = (3, 8, 15, 23, 32, 41, 49, 56, 61, 64, 64, 62, 58, 54, 51, 50, 50)
        for height in heights:
            self._go(plot, start - QPoint(0, height), 1.0)
        QTest.mouseRelease(plot, LEFT, pos=start - QPoint(0, heights[-1]))
        wait(0.4)
        self._frame(600)
        do(window, "undo")
        wait(0.4)
        self._frame(700)
        path = PICTURES / f"{name}.webp"
        first, *others = self._frames
        first.save(
            path, save_all=True, append_images=others, duration=self._lasts, loop=0, quality=72
        )

    def _go(self, widget: QWidget, to: QPoint, share: float) -> None:
        """Move the pointer a share of the way."""
        aim = QPointF(widget.mapTo(self._window, to))
        self._pointer += (aim - self._pointer) * share
        QTest.mouseMove(widget, widget.mapFrom(self._window, self._pointer.toPoint()))
        wait(0.06)
        self._frame(FRAME_MS)

    def _frame(self, lasts: int) -> None:
        """The window as it is now; grabbed pictures have no pointer, so it is painted in."""
        picture = self._window.grab().toImage()
        with QPainter(picture) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.translate(self._pointer)
            painter.setPen(QPen(QColor("black"), 1.4))
            painter.setBrush(QColor("white"))
            painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in POINTER]))
        picture = picture.convertToFormat(QImage.Format.Format_RGB888)
        size = (picture.width(), picture.height())
        image = Image.frombytes(
            "RGB", size, bytes(picture.constBits()), "raw", "RGB", picture.bytesPerLine()
        )
        height = round(FILM_WIDTH * size[1] / size[0])
        self._frames.append(image.resize((FILM_WIDTH, height), Image.Resampling.LANCZOS))
        self._lasts.append(lasts)


def go_to(window: MainWindow, editor: Editor, kind: str) -> None:
    """The first problem of a kind."""
    editor.problems.search()
    kinds = [problem.kind.value for problem in editor.problems.problems]
    window.commands.fix.go_to(kinds.index(kind))


def do(window: MainWindow, command: str) -> None:
    """Trigger a command, as the menu would."""
    window.actions_[command].trigger()


def place(editor: Editor, seconds: float, y: float) -> QPoint:
    """The position of a time on the first plot."""
    plot = editor.curves.plots[0]
    at: QPoint = plot.mapFromScene(
        plot.view.mapToScene(QPointF(plot.current_scale.x_of(seconds), y))
    )
    return at


def drag(widget: QWidget, start: QPoint, by: QPoint, release: bool = True) -> None:
    """Press, move and release."""
    QTest.mouseMove(widget, start)
    QTest.mousePress(widget, LEFT, pos=start)
    for step in range(1, 6):
        QTest.mouseMove(widget, start + by * step / 5)
        wait(0.03)
    if release:
        QTest.mouseRelease(widget, LEFT, pos=start + by)


def wait_until(done: Callable[[], bool]) -> None:
    """Let the window do its work until something is done."""
    until = time.monotonic() + 120
    while not done():
        assert time.monotonic() < until
        wait(0.02)


def wait(seconds: float) -> None:
    """Let the window do its work."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        QApplication.processEvents()
        time.sleep(0.01)


def picture(window: MainWindow, name: str) -> None:
    """The window as it is now."""
    wait(0.5)
    window.grab().save(str(PICTURES / f"{name}.png"))


def shortcuts() -> str:
    """All shortcuts and gestures, from the tables behind the menus and the help."""
    parts = [
        "# Shortcuts\n",
        "Written by `docs/make_screenshots.py`; the same list is in the window under"
        " Help > Shortcuts (F1).\n",
    ]
    for section, rows in groupby(help_rows(), key=lambda row: row[0]):
        parts += [f"## {section}\n", "| keys or mouse | what it does |", "|---|---|"]
        parts += [f"| {keys.replace('|', '&#124;')} | {text} |" for _, keys, text in rows]
        parts.append("")
    return "\n".join(parts)


if __name__ == "__main__":
    main()
