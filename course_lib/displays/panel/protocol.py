"""All that the panels and their page send each other: a state and its changes, and orders.

``viewer/js/protocol.d.ts`` is generated from these classes: ``python -m tests.viewer.declarations``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias, get_args

from course_lib.arrays import Vector
from course_lib.displays.panel.controls import ChooseEntry, ContextMenu, UseControl
from course_lib.displays.statuses import Level
from course_lib.displays.view_controller import Hands

EditorKind: TypeAlias = Literal[
    "bool", "color", "enum", "frame", "integer", "none", "number", "text", "topic", "vector"
]
Gesture: TypeAlias = Literal["interact", "camera", "select", "focus", "measure", "pose", "point"]


@dataclass(frozen=True)
class Editor:
    """The control of a row, and its limits."""

    kind: EditorKind
    low: float | None = None
    high: float | None = None
    options: tuple[str, ...] = ()  # of an enum
    type: str = ""  # of the messages on a topic


@dataclass(frozen=True)
class LevelMark:
    """A status level: for programs, as an icon, and in a word."""

    level: Level
    icon: str
    word: str


@dataclass(frozen=True)
class PanelRow:
    """One row of a tree."""

    key: str
    parent: str  # its key, or "" at the top
    label: str
    text: str = ""
    value: Any = None
    checked: bool | None = None  # of the box that shows or hides a display
    open: bool = False  # at first
    title: str = ""
    mark: LevelMark | None = None
    editor: Editor | None = None


@dataclass(frozen=True)
class ToolButton:
    """One button of the tool bar."""

    label: str
    key: str
    gesture: Gesture


@dataclass(frozen=True)
class ToolSettings:
    """The properties of tools that the page itself follows."""

    single: bool  # of Publish Point
    color: str  # of Measure


@dataclass(frozen=True)
class ViewChoice:
    """The type of the view, the types there are, and the names of the saved views."""

    type: str
    types: tuple[str, ...]
    saved: tuple[str, ...]


@dataclass(frozen=True)
class StatusLine:
    """The worst status, in one line."""

    mark: LevelMark
    text: str


@dataclass(frozen=True)
class Notice:
    """The answer to the last order; without a text there is nothing to say."""

    level: Literal["", "ok", "error"] = ""
    text: str = ""


@dataclass(frozen=True)
class AddableType:
    """A class of display."""

    name: str
    short: str


@dataclass(frozen=True, order=True)
class AddableTopic:
    """A topic, and a class of display for it."""

    topic: str
    type: str
    display: str


@dataclass(frozen=True)
class Layouts:
    """The .rviz files in the notebook's folder, and the one that was used last."""

    last: str
    files: tuple[str, ...]


@dataclass(frozen=True)
class PanelState:
    """All that the panels show; `tree`, `view` and `tools` hold the keys of their rows, parents first."""

    tree: tuple[str, ...]
    view: tuple[str, ...]
    tools: tuple[str, ...]
    toolbar: tuple[ToolButton, ...]
    settings: ToolSettings
    hands: Hands
    views: ViewChoice
    status: StatusLine
    notice: Notice
    selection: str
    types: tuple[AddableType, ...]
    topics: tuple[AddableTopic, ...]
    handles: tuple[str, ...]  # nodes below which interactive markers are, that can be dragged
    menu: ContextMenu
    frames: tuple[str, ...]
    layouts: Layouts
    summary: str


@dataclass(frozen=True)
class PanelNews:
    """The fields of the state and the rows that have changed, and the keys of rows that are gone."""

    changed: Annotated[Mapping[str, Any], "Partial<PanelState>"]
    rows: Mapping[str, PanelRow]
    gone: tuple[str, ...]


@dataclass(frozen=True)
class OpenPanels:
    """A page has come that knows nothing yet."""


@dataclass(frozen=True)
class LookAgain:
    """Somebody wants to see what is new."""


@dataclass(frozen=True)
class SetValue:
    """Edit a row, or tick its box."""

    row: str
    value: Any


@dataclass(frozen=True)
class AddDisplay:
    """Add a display, to the group that is chosen."""

    display: str  # its class
    topic: str = ""
    row: str = ""


@dataclass(frozen=True)
class DuplicateDisplay:
    """Add a copy of a display."""

    row: str


@dataclass(frozen=True)
class RenameRow:
    """Change the name of a display or a group."""

    row: str
    name: str


@dataclass(frozen=True)
class RemoveRow:
    """Remove a display or a group."""

    row: str


@dataclass(frozen=True)
class SaveLayout:
    """Write an .rviz file into the notebook's folder."""

    name: str


@dataclass(frozen=True)
class LoadLayout:
    """Open an .rviz file of the notebook's folder."""

    name: str


@dataclass(frozen=True)
class ChangeView:
    """Change the type of view."""

    view: str


@dataclass(frozen=True)
class HomeView:
    """Look from where a new view does."""


@dataclass(frozen=True)
class SaveView:
    """Save the view as it is now."""

    name: str


@dataclass(frozen=True)
class UseView:
    """Look as a saved view does."""

    index: int


@dataclass(frozen=True)
class RenameView:
    """Change the name of a saved view."""

    index: int
    name: str


@dataclass(frozen=True)
class RemoveView:
    """Remove a saved view."""

    index: int


@dataclass(frozen=True)
class TurnView:
    """The view was turned by hand; points in the fixed frame, [m]."""

    eye: Vector
    target: Vector
    up: Vector
    scale: float  # pixels per metre, 0 with perspective


@dataclass(frozen=True)
class SelectObject:
    """An object was clicked, or the background."""

    path: str | None = None
    index: int | None = None


@dataclass(frozen=True)
class PublishGesture:
    """A tool was used at a point in the fixed frame, [m], with an angle about z, [rad]."""

    tool: str
    point: Vector
    angle: float = 0.0


Order: TypeAlias = (
    OpenPanels | LookAgain | SetValue | AddDisplay | DuplicateDisplay | RenameRow | RemoveRow
    | SaveLayout | LoadLayout | ChangeView | HomeView | SaveView | UseView | RenameView | RemoveView
    | TurnView | SelectObject | PublishGesture | UseControl | ChooseEntry
)  # fmt: skip
ORDERS: Mapping[str, type[Order]] = {kind.__name__: kind for kind in get_args(Order)}  # by their "act"
