"""Commands as Qt actions: menus, shortcuts, states and help come from tables of commands.

The tables are in `ui/commands`, one per menu, beside the methods that carry them out.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, TypeVar

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeyEvent, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu

from faceedit_app.ui.look.icons import icon
from faceedit_app.ui.state.document import Document

Doer = TypeVar("Doer")
NO_TAKE = "Open a take first: File > Open…"
TIP = "tip"  # the property of a command that says what it does, also while it is not possible
_LONGEST = 40  # characters of a detail


@dataclass(frozen=True)
class When(Generic[Doer]):
    """When a command is possible.

    Attributes:
        test: whether it is, given the object whose command it is.
        why_not: one sentence for the user if it is not, with what can be done.
    """

    test: Callable[[Doer], bool]
    why_not: str


@dataclass(frozen=True)
class Command(Generic[Doer]):
    """One thing that the user can do.

    Attributes:
        id: its name in code and tests.
        text: its text in the menu; “&” marks the mnemonic.
        run: carries it out, given the object whose command it is; None for a submenu.
        keys: shortcuts, the first of which is shown.
        tip: one sentence for tooltips, the status bar and the list of shortcuts.
        icon: name of its icon, or nothing.
        detail: added to the text, such as the step that Undo undoes.
        enabled: when it is possible; None: always.
        checked: whether the state that it switches is on; None: it switches none.
        needs_take: whether it is disabled while no take is open.
        starts_group: whether a line separates it from the command above.
        submenu: the submenu that it is in, if any.
        fills: for a submenu: fills it, each time it is opened.
    """

    id: str
    text: str
    run: Callable[[Doer], object] | None = None
    keys: tuple[str, ...] = ()
    tip: str = ""
    icon: str = ""
    detail: Callable[[Doer], str] | None = None
    enabled: When[Doer] | None = None
    checked: Callable[[Doer], bool] | None = None
    needs_take: bool = True
    starts_group: bool = False
    submenu: str = ""
    fills: Callable[[Doer, QMenu], None] | None = None


@dataclass(frozen=True)
class Menu(Generic[Doer]):
    """A menu of the menu bar: its name, and its commands from top to bottom.

    The letter after `&` in the title opens it with Alt; each menu needs its own.
    """

    title: str
    commands: tuple[Command[Doer], ...]

    @property
    def name(self) -> str:
        """Its title without the mark."""
        return self.title.replace("&", "")


class Actions:
    """The commands of a window as Qt actions, with the menus that hold them.

    Views look actions up by id to show them on buttons. Each command says whether it is enabled and
    checked; that is read after each command and whenever `refresh` is called.

    Args:
        window: gets the menus and the shortcuts.
        document: the take that commands may need.
        menus: each menu with the object that carries out its commands.
    """

    def __init__(
        self,
        window: QMainWindow,
        document: Document,
        menus: Iterable[tuple[Menu[Any], Any]],
    ) -> None:
        self._window, self._document = window, document
        self._actions: dict[str, QAction] = {}
        self._submenus: dict[str, QMenu] = {}
        self._commands: list[tuple[Command[Any], Any]] = []
        self._running = 0  # commands, and what else is held
        for menu, doer in menus:
            self._fill(menu, doer)
        self.refresh()

    def __getitem__(self, name: str) -> QAction:
        return self._actions[name]

    def submenu(self, name: str) -> QMenu:
        """The submenu of a command with `fills`."""
        return self._submenus[name]

    def refresh(self) -> None:
        """Show which commands are enabled and checked.

        While a command runs, this waits for its end: one changes many things, each of which asks.
        """
        if self._running:
            return
        is_open = self._document.session is not None
        for command, doer in self._commands:
            action = self._actions[command.id]
            why_not = "" if is_open or not command.needs_take else NO_TAKE
            if not why_not and command.enabled is not None and not command.enabled.test(doer):
                why_not = command.enabled.why_not
            self._show_why(action, command.tip, why_not)
            if command.checked is not None:
                action.setChecked(command.checked(doer))
            if command.detail is not None:
                action.setText(f"{command.text} {_in_menu(command.detail(doer))}".rstrip())

    @staticmethod
    def _show_why(action: QAction, tip: str, why_not: str) -> None:
        """Enable a command, or say in its tooltip and in the status bar why it is not possible."""
        before = action.data() or ""
        action.setEnabled(not why_not)
        if why_not == before:
            return
        action.setData(why_not)
        action.setStatusTip(why_not or tip)
        action.setToolTip("\n".join(filter(None, (tip_of(action, before), why_not))))

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """Refresh once, at the end of what changes many things."""
        self._running += 1
        try:
            yield
        finally:
            self._running -= 1
            self.refresh()

    def why_not(self, event: QKeyEvent) -> str:
        """Why the command of a key is not possible now; "" if it is, or if the key has none."""
        keys = QKeySequence(event.keyCombination())
        theirs = (action for action in self._actions.values() if keys in action.shortcuts())
        return next((action.data() or "" for action in theirs if not action.isEnabled()), "")

    def _fill(self, menu: Menu[Any], doer: Any) -> None:
        outer = self._window.menuBar().addMenu(menu.title)
        inner: dict[str, QMenu] = {}
        for command in menu.commands:
            place = outer
            if command.starts_group:
                outer.addSeparator()
            if command.submenu:
                if command.submenu not in inner:
                    inner[command.submenu] = outer.addMenu(command.submenu)
                place = inner[command.submenu]
            action = self._create(command, doer)
            place.addAction(action)
            self._actions[command.id] = action
            self._commands.append((command, doer))

    def _create(self, command: Command[Any], doer: Any) -> QAction:
        if command.fills is not None:
            menu = self._submenus[command.id] = QMenu(command.text, self._window)
            menu.aboutToShow.connect(partial(command.fills, doer, menu))
            return menu.menuAction()
        action = QAction(command.text, self._window)
        action.setObjectName(command.id)
        action.setCheckable(command.checked is not None)
        action.setShortcuts([QKeySequence(keys) for keys in command.keys])
        action.setShortcutContext(Qt.ShortcutContext.WindowShortcut)
        if command.icon:
            action.setIcon(icon(command.icon))
        if command.tip:
            keys = f"  ({shown_keys(command.keys[0])})" if command.keys else ""
            action.setToolTip(command.tip + keys)
            action.setStatusTip(command.tip)
            action.setProperty(TIP, command.tip)
        action.triggered.connect(lambda _checked=False: self._run(command, doer))
        return action

    def _run(self, command: Command[Any], doer: Any) -> None:
        assert command.run is not None
        with self.held():  # Qt toggled the action even if the command does nothing
            command.run(doer)


def tip_of(action: QAction, why_not: str = "") -> str:
    """The tooltip of a command, without the reason why it is not possible now, if that is shown."""
    return action.toolTip().removesuffix(f"\n{why_not or action.data()}")


def _in_menu(detail: str) -> str:
    """The user's text, shortened for a menu, without mnemonics and tabs."""
    words = " ".join(detail.split())
    if len(words) > _LONGEST:
        words = words[: _LONGEST - 1].rstrip() + "…"
    return words.replace("&", "&&")


def shown_keys(keys: str) -> str:
    """A shortcut as this platform spells it, such as ⌘Z."""
    return QKeySequence(keys).toString(QKeySequence.SequenceFormat.NativeText)


def help_rows(menus: Iterable[Menu[Any]]) -> Iterator[tuple[str, str, str]]:
    """(menu, keys, effect) of every command with a shortcut."""
    for menu in menus:
        for command in menu.commands:
            if command.keys:
                keys = "  or  ".join(shown_keys(k) for k in command.keys)
                yield menu.name, keys, command.tip or command.text.replace("&", "").rstrip("…")
