"""The Tools menu: what a drag on a curve does, and moving a curve with the keyboard."""

from __future__ import annotations

from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.state.actions import Command, Menu
from faceedit_app.ui.state.tools import Tool

STEP, FINE_STEP = 0.5, 0.05  # mm


class ToolCommands:
    """Chooses tools; raises and lowers the focused curve."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace, self._tools = workspace, workspace.tools

    @property
    def tool(self) -> Tool:
        """The current tool."""
        return self._tools.tool

    def choose(self, tool: Tool) -> None:
        """Choose a tool."""
        self._tools.choose(tool)

    @property
    def linked(self) -> bool:
        """Whether left and right are edited together."""
        return self._tools.linked

    def link(self) -> None:
        """Link or unlink left and right."""
        self._tools.link(not self._tools.linked)

    @property
    def is_curve_chosen(self) -> bool:
        """Whether the curve that has the focus is edited together with others."""
        page = self._workspace.page
        return page is not None and page.curves.is_focused_chosen

    def choose_curve(self) -> None:
        """Choose the focused curve, or remove it from the chosen ones."""
        if self._workspace.page is not None:
            self._workspace.page.curves.choose_focused()

    def nudge(self, millimetres: float) -> None:
        """Move the focused curve."""
        page = self._workspace.page
        if page is not None:
            self._workspace.commit_gestures()
            page.curves.nudge(millimetres)


# fmt: off
MENU: Menu[ToolCommands] = Menu("T&ools", (
    Command("tool_move", "&Move", lambda do: do.choose(Tool.MOVE), ("M",),
            "Drag a curve up or down; the change fades out on either side", "tool_move",
            checked=lambda do: do.tool is Tool.MOVE),
    Command("tool_draw", "&Draw", lambda do: do.choose(Tool.DRAW), ("D",),
            "Draw a curve freehand; hold Ctrl to draw at 0, where lips or lids touch", "tool_draw",
            checked=lambda do: do.tool is Tool.DRAW),
    Command("tool_smooth", "&Smooth", lambda do: do.choose(Tool.SMOOTH), ("S",),
            "Paint over a shaky curve to smooth it; the slider sets the strength",
            "tool_smooth", checked=lambda do: do.tool is Tool.SMOOTH),
    Command("tool_scale", "S&cale", lambda do: do.choose(Tool.SCALE), ("X",),
            "Drag up to enlarge movements, down to reduce them", "tool_scale",
            checked=lambda do: do.tool is Tool.SCALE),
    Command("tool_flatten", "&Flatten", lambda do: do.choose(Tool.FLATTEN), ("H",),
            "Paint to hold the curve at the value where you pressed", "tool_flatten",
            checked=lambda do: do.tool is Tool.FLATTEN),
    Command("tool_restore", "&Back to tracked", lambda do: do.choose(Tool.RESTORE), ("R",),
            "Paint over edits to erase them; the face goes back to the tracked take",
            "tool_restore", checked=lambda do: do.tool is Tool.RESTORE),
    Command("tool_retime", "R&etime", lambda do: do.choose(Tool.RETIME), ("W",),
            "Drag the face or the selection sideways to show it earlier or later, an end of the "
            "selection to stretch it", "tool_retime", checked=lambda do: do.tool is Tool.RETIME),
    Command("link", "&Left = right", ToolCommands.link, ("U",),
            "Edit both sides of the face together; hold Alt, or Ctrl and Shift, to edit one side",
            "link",
            checked=lambda do: do.linked, starts_group=True),
    Command("choose_curve", "Edit with &others", ToolCommands.choose_curve,
            tip="Edit the focused curve with the other chosen ones; or Ctrl-click its name",
            checked=lambda do: do.is_curve_chosen),
    Command("raise", "&Raise the curve", lambda do: do.nudge(STEP), ("Ctrl+Up",),
            "Raise the focused curve by 0.5 mm, at the playhead or in the selection",
            starts_group=True),
    Command("lower", "Lo&wer the curve", lambda do: do.nudge(-STEP), ("Ctrl+Down",),
            "Lower the focused curve by 0.5 mm"),
    Command("raise_fine", "Raise a l&ittle", lambda do: do.nudge(FINE_STEP), ("Ctrl+Shift+Up",),
            "Raise the focused curve by 0.05 mm"),
    Command("lower_fine", "Lower &a little", lambda do: do.nudge(-FINE_STEP),
            ("Ctrl+Shift+Down",), "Lower the focused curve by 0.05 mm"),
))
# fmt: on
