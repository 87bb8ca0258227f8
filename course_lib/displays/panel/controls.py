"""Messages between a page and the interactive markers that it drags and clicks."""

from dataclasses import dataclass

from course_lib.arrays import Vector


@dataclass(frozen=True)
class MenuItem:
    """An entry of a context menu; one that opens further entries cannot be chosen."""

    id: int
    text: str
    opens: bool = False


@dataclass(frozen=True)
class ContextMenu:
    """The menu that was asked for last, of an interactive marker; each has another number."""

    number: int = 0
    path: str = ""
    entries: tuple[MenuItem, ...] = ()


@dataclass(frozen=True)
class UseControl:
    """The pointer is at work on an interactive marker; points and rays in the fixed frame, [m]."""

    path: str  # of what was pressed
    event: str  # "down", "move", "up" or "cancel"
    button: int  # that was pressed: 0 left, 2 right
    origin: Vector
    direction: Vector
    eye: Vector
    target: Vector
    up: Vector
    scale: float  # pixels per metre, 0 with perspective
    pixel: float  # size of a pixel at a distance of 1 m, without perspective everywhere
    shift: bool
    ctrl: bool
    point: Vector | None = None  # what is below the pointer


@dataclass(frozen=True)
class ChooseEntry:
    """An entry of an interactive marker's menu was chosen."""

    path: str
    entry: int
