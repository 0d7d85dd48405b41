"""The Fix menu: one-click fixes, the user's presets, and problems with their fixes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.help.presets import Preset, shipped_presets
from faceedit_app.formats.timing import counted
from faceedit_app.ui.commands import conditions as c
from faceedit_app.ui.commands.calibration import CalibrationCommands
from faceedit_app.ui.commands.own_presets import OwnPresetCommands
from faceedit_app.ui.commands.words import WordCommands
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.edits.slider_dialog import End, SliderDialog
from faceedit_app.ui.state.actions import Command, Menu

if TYPE_CHECKING:  # the window is there before the solver
    from faceedit_app.editing.help.problems import Problem


class FixCommands:
    """Applies fixes and presets, and steps through problems."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._document, self._timeline = workspace.document, workspace.timeline
        self.words = WordCommands(workspace)
        self.calibration = CalibrationCommands(workspace)
        self.presets = OwnPresetCommands(workspace, self.apply)
        self._said: tuple[Problem, str] | None = None  # where one is, and what was said of it
        self._timeline.playhead_moved.connect(self._leave_problem)

    # --- fixes -------------------------------------------------------------------------------

    def apply(self, preset: Preset) -> None:
        """Make a preset's edits as one step and select them, ready for their strength to be set."""
        edits = self._edits_of(preset)
        if edits:
            self._workspace.add_edits(edits, preset.name)

    def _edits_of(self, preset: Preset) -> tuple[Edit, ...]:
        """The edits that a preset would make now."""
        from faceedit_app.editing.help.fixes import apply_preset

        session, line = self._document.session, self._timeline
        if session is None:
            return ()
        self._workspace.end_gestures()
        return apply_preset(session, preset, line.own_selection, line.time, line.falloff)

    def expression(self) -> None:
        """Show the slider from sad to smiling."""
        if self._document.session is None:
            return
        presets = {preset.id: preset for preset in shipped_presets()}
        span = self._timeline.own_selection
        where = f"from {self._workspace.shown_range(*span)}" if span else "in the whole take"
        SliderDialog(
            self._workspace.window,
            self._document,
            "Smile or sad",
            f"How happy the mouth looks {where}:",
            End("sad", "sad", self._edits_of(presets["sad_mouth"])),
            End("smile", "smile", self._edits_of(presets["smile"])),
            lambda edits: self._workspace.add_edits(edits, edits[0].name),
        ).show()

    @property
    def has_range(self) -> bool:
        """Whether a time range is selected, to be filled."""
        return self._timeline.has_range

    def fill(self) -> None:
        """Preview other motion of the take in place of the selection, in four variations."""
        from faceedit_app.editing.help import fill

        session, page = self._document.session, self._workspace.page
        self._workspace.end_gestures()
        if session is None or page is None or (selection := self._timeline.selection) is None:
            return
        if why := fill.cannot_fill(session.take, *selection):
            self._workspace.message.emit(why)
            return
        sound = self._workspace.media.sound
        heard = fill.Heard(sound.item, sound.offset) if sound is not None else None
        edit = fill.fill_edit(session, *selection, heard)
        text = fill.filled_message(session.take, *selection, bool(edit.points))
        found = [(each,) for each in fill.variations(edit)]
        short = fill.filled_briefly(session.take, *selection)
        page.proposal.offer(text, (edit,), "Fill", short=short, variations=found)

    def vary(self, by: int) -> None:
        """Show the next variation of the proposal, or the previous one."""
        page = self._workspace.page
        if page is not None and page.proposal.has_variations:
            page.proposal.vary(page.proposal.variation + by)

    @property
    def has_variations(self) -> bool:
        """Whether the proposal has variations."""
        page = self._workspace.page
        return page is not None and page.proposal.has_variations

    # --- problems ----------------------------------------------------------------------------

    @property
    def problems(self) -> tuple[Problem, ...]:
        """All problems found."""
        page = self._workspace.page
        return page.problems.problems if page is not None else ()

    @property
    def problem(self) -> Problem | None:
        """The problem at the playhead."""
        page = self._workspace.page
        return page.problems.current_problem if page is not None else None

    def step(self, by: int) -> None:
        """Go to the next problem, or to the previous one."""
        page = self._workspace.page
        if page is not None:
            index = page.problems.step(by)
            if index is not None:
                self.go_to(index)

    def go_to(self, index: int) -> None:
        """Show a problem; a proposal for all of them stays, so that one can look at each."""
        page = self._workspace.page
        if page is not None:
            if not page.proposal.is_for_all:
                page.proposal.discard()
            page.problems.go_to(index)
            problem = page.problems.problems[index]
            made = page.problem_list.model.made_by(problem)
            more = problem.why_unfixed or (made and f"its fix {made}")
            text = f"{problem.message}; {more}" if more else problem.message
            self._said = problem, text
            self._workspace.message.emit(text)

    def _leave_problem(self) -> None:
        """Elsewhere, nothing is said of a problem any more."""
        if self._said is None:
            return
        (problem, text), now = self._said, self._timeline.time
        if not problem.is_at(now):
            self._said = None
            self._workspace.retracted.emit(text)

    def fix_problem(self) -> None:
        """Preview a fix for the problem at the playhead."""
        from faceedit_app.editing.help.fill import faces_given, variations_of

        page, problem, session = self._workspace.page, self.problem, self._document.session
        if page is not None and session is not None and problem is not None and problem.fix:
            self._workspace.end_gestures()
            said = f"{problem.message[:1].lower()}{problem.message[1:]}"
            given = faces_given(session.take, problem.fix)
            made = page.problem_list.model.made_by(problem)
            but = f" The fix {made}." if made else ""
            message = f"{given or 'Fix shown'}. The problem: {said}.{but}"
            found = variations_of(problem.fix)
            short = given or (f"The fix {made}" if made else problem.message.partition(";")[0])
            page.proposal.offer(
                message, problem.fix, "Fix problem", problem, short=short, variations=found
            )

    def fix_all(self) -> None:
        """Preview fixes for all problems that are ticked in the list, and show the list."""
        page = self._workspace.page
        if page is None:
            return
        self._workspace.end_gestures()
        page.list_problems()
        page.problem_list.trials.begin()
        chosen = page.problem_list.chosen
        edits = tuple(edit for problem in chosen for edit in problem.fix)
        if edits:
            count = counted(len(chosen), "problem")
            text = f"Fixes for {count} are shown; {page.problem_list.advice}"
            short = page.problem_list.short_advice
            page.proposal.offer(text, edits, f"Fix {count}", short=short)

    @property
    def can_fix_all(self) -> bool:
        """Whether a problem that can be fixed is ticked."""
        page = self._workspace.page
        return page is not None and bool(page.problem_list.chosen)

    def tick_problem(self) -> None:
        """Tick the problem at the playhead, or untick it."""
        page, problem = self._workspace.page, self.problem
        if page is not None and problem is not None:
            model = page.problem_list.model
            model.tick((problem,), not model.is_ticked(problem))

    def tick_all(self, on: bool) -> None:
        """Tick all problems in the list, or none."""
        page = self._workspace.page
        if page is not None:
            page.problem_list.model.tick_all(on)

    @property
    def is_ticked(self) -> bool:
        """Whether the problem at the playhead is ticked."""
        page, problem = self._workspace.page, self.problem
        return (
            page is not None and problem is not None and page.problem_list.model.is_ticked(problem)
        )

    @property
    def can_tick(self) -> bool:
        """Whether the list has problems that can be fixed."""
        page = self._workspace.page
        return page is not None and page.problem_list.model.can_tick

    @property
    def can_fix(self) -> bool:
        """Whether the problem at the playhead can be fixed."""
        return self.problem is not None and bool(self.problem.fix)

    def list_problems(self) -> None:
        """Show the list of problems."""
        page = self._workspace.page
        if page is not None:
            page.list_problems()
            if page.problem_list.rows.isVisible():  # it is empty else
                page.problem_list.rows.setFocus()

    @property
    def has_proposal(self) -> bool:
        """Whether there is a proposal."""
        page = self._workspace.page
        return page is not None and page.proposal.is_open

    def accept(self) -> None:
        """Accept the proposal; after the fix of one problem, go on to the next."""
        page = self._workspace.page
        if page is None or not page.proposal.is_open or page.proposal.waits_for(page.trials):
            return
        count, fixed = len(self._edits), page.proposal.problem
        page.proposal.accept()
        page.edits.select_new(len(self._edits) - count)
        new = page.problems.search()
        if fixed is not None:
            following = page.problems.next_fixable(fixed.time)
            if following is None:
                self._workspace.message.emit("There are no more problems that can be fixed")
            else:
                page.edits.leave()  # its handles would stay where one no longer looks
                self.go_to(following)
        if new:
            self._workspace.message.emit(page.problems.words_for(new))

    @property
    def _edits(self) -> tuple[Edit, ...]:
        session = self._document.session
        return session.edits if session is not None else ()

    def discard(self) -> None:
        """Discard the proposal."""
        page = self._workspace.page
        if page is not None:
            page.proposal.discard()


# Submenus: with all their commands, the menu would be higher than a small screen.
WORDS, PROBLEMS = "Spo&ken words", "Problems in the &take"


def _fixes() -> Iterator[Command[FixCommands]]:
    """A command for each shipped preset."""
    groups = [preset.group for preset in shipped_presets()]
    starts = [False, *(one != other for one, other in pairwise(groups))]
    for preset, starts_group in zip(shipped_presets(), starts, strict=True):
        yield Command(
            f"fix_{preset.id}",
            preset.menu,
            partial(FixCommands.apply, preset=preset),
            (preset.key,) if preset.key else (),
            preset.hint,
            preset.icon,
            starts_group=starts_group,
        )


# fmt: off
MENU: Menu[FixCommands] = Menu("Fi&x", (
    *_fixes(),
    Command("expression", "S&mile or sad…", FixCommands.expression, ("Ctrl+0",),
            "Set how happy the mouth looks, in the selection or the whole take",
            starts_group=True),
    Command("fill", "&Fill", FixCommands.fill, ("Ctrl+I",),
            "Replace the selection, up to 4 s, with other motion of the take that fits both sides",
            enabled=c.HAS_RANGE),
    Command("presets", "My p&resets", fills=lambda do, menu: do.presets.fill(menu)),
    Command("save_preset", "Sa&ve selection as preset…", lambda do: do.presets.save(), (),
            "Save the edits in the selection under a name, to use them elsewhere"),
    Command("close_on_words", "Close l&ips on m, b, p", lambda do: do.words.close_lips(), (),
            "Close the lips at each m, b and p that stays open, in the selection or the whole take",
            "lips", enabled=c.HAS_WORDS, starts_group=True, submenu=WORDS),
    Command("shape_on_words", "Shape lips on f, w, s&h", lambda do: do.words.shape_lips(), (),
            "Shape the lips at f, w, oo, sh and ch, in the selection or the whole take",
            enabled=c.HAS_WORDS, submenu=WORDS),
    Command("say_clearly", "Say it clearl&y…", lambda do: do.words.say_clearly(), (),
            "Set how clearly the words are said, with lips that still meet",
            enabled=c.HAS_WORDS, submenu=WORDS),
    Command("neutral_frame", "This frame is ne&utral", lambda do: do.calibration.this_frame(), (),
            "Subtract the pose at the playhead from the selection or the whole take; blinks and "
            "words keep their height", starts_group=True),
    Command("levels", "Strengt&h by channel…", lambda do: do.calibration.levels(), (),
            "Set multiplier, offset and soft limit of each channel, as one edit"),
    Command("next_problem", "&Next problem", lambda do: do.step(1), ("Down",),
            "Go to the next problem", "down",
            enabled=c.HAS_PROBLEMS, starts_group=True, submenu=PROBLEMS),
    Command("previous_problem", "Previous problem", lambda do: do.step(-1), ("Up",),
            "Go to the previous problem", "up",
            enabled=c.HAS_PROBLEMS, submenu=PROBLEMS),
    Command("fix_problem", "Fi&x this problem", FixCommands.fix_problem, ("P",),
            "Preview a fix for the problem at the playhead, to accept or discard",
            enabled=c.CAN_FIX, submenu=PROBLEMS),
    Command("fix_all", "Fix all problems", FixCommands.fix_all, ("Ctrl+Shift+P",),
            "Preview fixes for all problems that are ticked in the list, to accept or discard",
            enabled=c.CAN_FIX_ALL, submenu=PROBLEMS),
    Command("list_problems", "&List of problems", FixCommands.list_problems, ("Ctrl+P",),
            "Show the problems as a list: what, when and how bad", submenu=PROBLEMS),
    Command("tick_problem", "&Tick this problem", FixCommands.tick_problem, ("Shift+P",),
            "Tick the problem at the playhead in the list, or untick it", submenu=PROBLEMS,
            enabled=c.CAN_FIX, checked=lambda do: do.is_ticked),
    Command("tick_all", "Tick all", lambda do: do.tick_all(True), (),
            "Tick all problems in the list, to fix them together",
            enabled=c.CAN_TICK, submenu=PROBLEMS),
    Command("untick_all", "&Untick all", lambda do: do.tick_all(False), (),
            "Untick all problems in the list, to tick the few that you want fixed",
            enabled=c.CAN_TICK, submenu=PROBLEMS),
    Command("previous_variation", "Previous variation", lambda do: do.vary(-1), ("[",),
            "Show the previous variation of the proposal", "back",
            enabled=c.HAS_VARIATIONS, submenu=PROBLEMS),
    Command("next_variation", "Next &variation", lambda do: do.vary(1), ("]",),
            "Show the next variation of the proposal", "forward",
            enabled=c.HAS_VARIATIONS, submenu=PROBLEMS),
    Command("accept_fix", "Accept the proposal", FixCommands.accept, ("Return", "Enter"),
            "Make the proposed edits", "tick",
            enabled=c.HAS_PROPOSAL, submenu=PROBLEMS),
    Command("discard_fix", "Discard the proposal", FixCommands.discard, (),
            "Discard the proposed edits (Esc)", "close",
            enabled=c.HAS_PROPOSAL, submenu=PROBLEMS),
))
# fmt: on
