"""The messages between the panels and their page: the state, its changes, and commands of the page.

``viewer/js/protocol.d.ts`` is generated from these classes: ``python -m
tests.viewer.declarations``.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from course_lib.arrays import Vector
from course_lib.displays.statuses import Level
from course_lib.displays.views import DragRules
from course_lib.viewer.encoding import Message


class MenuItem(Message, frozen=True):
    """An entry of a context menu. An entry with a submenu cannot be chosen."""

    id: int
    text: str
    opens: bool = False


class ContextMenu(Message, frozen=True):
    """The latest context menu of an interactive marker; each menu has a new number."""

    number: int = 0
    path: str = ""
    entries: tuple[MenuItem, ...] = ()


class Command(Message, frozen=True, tag_field="act", tag=True):
    """Base class of the commands of a page. The field `act` contains the class name."""


class UseControl(Command, frozen=True):
    """The pointer acts on an interactive marker; points and rays are in the fixed frame [m]."""

    # Scene path of the pressed control.
    path: str
    # "down", "move", "up" or "cancel".
    event: str
    # Pressed button: 0 left, 2 right.
    button: int
    origin: Vector
    direction: Vector
    eye: Vector
    target: Vector
    up: Vector
    # Pixels per metre, 0 with perspective.
    scale: float
    # Size of a pixel at a distance of 1 m, or anywhere without perspective.
    pixel: float
    shift: bool
    ctrl: bool
    # Point below the pointer.
    point: Vector | None = None


class ChooseEntry(Command, frozen=True):
    """Choose an entry of an interactive marker's menu."""

    path: str
    entry: int


EditorKind: TypeAlias = Literal[
    "bool", "color", "enum", "frame", "integer", "none", "number", "text", "topic", "vector"
]
Gesture: TypeAlias = Literal["interact", "camera", "select", "focus", "measure", "pose", "point"]


class Editor(Message, frozen=True):
    """The control of a row, and its limits."""

    kind: EditorKind
    low: float | None = None
    high: float | None = None
    # Options of an enum.
    options: tuple[str, ...] = ()
    # Message type of a topic.
    type: str = ""


class LevelMark(Message, frozen=True):
    """A status level as an identifier, an icon and a word."""

    level: Level
    icon: str
    word: str


class PanelRow(Message, frozen=True):
    """One row of a tree."""

    key: str
    # Key of the parent row, or "".
    parent: str
    label: str
    text: str = ""
    value: Any = None
    # State of the check box of a display.
    checked: bool | None = None
    # Whether the row is expanded initially.
    open: bool = False
    title: str = ""
    mark: LevelMark | None = None
    editor: Editor | None = None


class ToolButton(Message, frozen=True):
    """One button of the tool bar."""

    label: str
    key: str
    gesture: Gesture


class ToolSettings(Message, frozen=True):
    """The properties of tools that the page itself uses."""

    # Whether Publish Point publishes a single point.
    single: bool
    # Color of the Measure line.
    color: str


class ViewChoice(Message, frozen=True):
    """The type of the view, all types, and the names of the saved views."""

    type: str
    types: tuple[str, ...]
    saved: tuple[str, ...]


class StatusLine(Message, frozen=True):
    """The worst status as a single line."""

    mark: LevelMark
    text: str


class Notice(Message, frozen=True):
    """The response to the last command; the text is empty if there is none."""

    level: Literal["", "ok", "error"] = ""
    text: str = ""


class AddableType(Message, frozen=True):
    """A class of display."""

    name: str
    short: str
    # A description of its drawing, or "".
    about: str = ""


class AddableTopic(Message, frozen=True, order=True):
    """A topic, and a class of display for it."""

    topic: str
    type: str
    display: str


class Layouts(Message, frozen=True):
    """The .rviz files in the notebook's folder, and the last used file."""

    last: str
    files: tuple[str, ...]


class PanelState(Message, frozen=True):
    """The whole state of the panels.

    `tree`, `view` and `tools` are the keys of their rows, parents first.
    """

    tree: tuple[str, ...]
    view: tuple[str, ...]
    tools: tuple[str, ...]
    toolbar: tuple[ToolButton, ...]
    settings: ToolSettings
    drag: DragRules
    views: ViewChoice
    status: StatusLine
    notice: Notice
    selection: str
    types: tuple[AddableType, ...]
    topics: tuple[AddableTopic, ...]
    # Scene nodes of draggable interactive markers.
    handles: tuple[str, ...]
    menu: ContextMenu
    frames: tuple[str, ...]
    layouts: Layouts
    summary: str


class PanelUpdate(Message, frozen=True):
    """The fields of the state and the rows that have changed, and the keys of removed rows."""

    changed: Annotated[Mapping[str, Any], "Partial<PanelState>"]
    rows: Mapping[str, PanelRow]
    gone: tuple[str, ...]


class OpenPanels(Command, frozen=True):
    """A new page requests the whole state."""


class RequestUpdate(Command, frozen=True):
    """Request an update."""


class WatchRows(Command, frozen=True):
    """Start or stop requesting changed rows, because a panel was opened or closed."""

    watched: bool


class SetValue(Command, frozen=True):
    """Edit a row, or tick its box."""

    row: str
    value: Any


class AddDisplay(Command, frozen=True):
    """Add a display to the selected group."""

    # Class name of the display.
    display: str
    topic: str = ""
    row: str = ""


class DuplicateDisplay(Command, frozen=True):
    """Add a copy of a display."""

    row: str


class RenameRow(Command, frozen=True):
    """Change the name of a display or group."""

    row: str
    name: str


class RemoveRow(Command, frozen=True):
    """Remove a display or group."""

    row: str


class SaveLayout(Command, frozen=True):
    """Write an .rviz file into the notebook's folder."""

    name: str


class LoadLayout(Command, frozen=True):
    """Open an .rviz file in the notebook's folder."""

    name: str


class ChangeView(Command, frozen=True):
    """Change the type of view."""

    view: str


class HomeView(Command, frozen=True):
    """Return to the defaults of the view."""


class SaveView(Command, frozen=True):
    """Save the current view."""

    name: str


class UseView(Command, frozen=True):
    """Switch to a saved view."""

    index: int


class RenameView(Command, frozen=True):
    """Change the name of a saved view."""

    index: int
    name: str


class RemoveView(Command, frozen=True):
    """Remove a saved view."""

    index: int


class TurnView(Command, frozen=True):
    """The user has moved the view; points are in the fixed frame [m]."""

    eye: Vector
    target: Vector
    up: Vector
    # Pixels per metre, 0 with perspective.
    scale: float


class SelectObject(Command, frozen=True):
    """An object or the background was clicked."""

    path: str | None = None
    index: int | None = None


class PublishGesture(Command, frozen=True):
    """A tool was used at a point in the fixed frame, [m], with an angle about z, [rad]."""

    tool: str
    point: Vector
    angle: float = 0.0


AnyCommand: TypeAlias = (
    OpenPanels | RequestUpdate | SetValue | AddDisplay | DuplicateDisplay | RenameRow | RemoveRow
    | SaveLayout | LoadLayout | ChangeView | HomeView | SaveView | UseView | RenameView | RemoveView
    | TurnView | SelectObject | PublishGesture | UseControl | ChooseEntry | WatchRows
)  # fmt: skip
