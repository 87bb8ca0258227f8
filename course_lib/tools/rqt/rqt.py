"""`%rqt …`: the table of its views, and perspectives, which store open views in a file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros import pace
from course_lib.ros.driving import running_nodes, wait_for
from course_lib.ros.graph import current_graph
from course_lib.ros.notices import say
from course_lib.ros.pace import SECONDS_WITHOUT_A_PAGE
from course_lib.tools.rqt.bag import BagView
from course_lib.tools.rqt.graph import GraphView
from course_lib.tools.rqt.monitors import ConsoleView, RobotMonitorView, TopicView
from course_lib.tools.rqt.plot import PlotView
from course_lib.tools.rqt.services import ReconfigureView, ServiceCallerView
from course_lib.tools.rqt.view import RqtView

_CLASSES = (
    GraphView,
    PlotView,
    ConsoleView,
    BagView,
    TopicView,
    ServiceCallerView,
    ReconfigureView,
    RobotMonitorView,
)
VIEWS: Mapping[str, type[RqtView]] = {view.name: view for view in _CLASSES}
_USAGE = f"Write %rqt {' | '.join(VIEWS)}, %rqt --perspective-file FILE, or %rqt save FILE."


@dataclass
class OpenViews:
    """The views of one run that are open."""

    by_words: dict[tuple[str, ...], RqtView] = field(default_factory=dict)


def rqt(words: Sequence[str]) -> None:
    """Run `rqt <words>`: show views below the cell.

    Raises:
        CourseError: No such view, or what the view or the file finds wrong.
    """
    match [word for word in words if word != "--force-discover"]:
        case ["--perspective-file", file]:
            _show([view for one in _read(Path(file)) for view in _restored(one, file)])
        case ["save" | "--save-config", file]:
            _save(Path(file))
        case [name, *rest] if not name.startswith("-"):
            _show([_view_class(name)(current_graph(), rest)])
        case _:
            raise CourseError(_USAGE)


def _view_class(name: str) -> type[RqtView]:
    plain = name.removeprefix("rqt_")
    if plain not in VIEWS:
        raise CourseError(
            f"rqt has no view {name!r} here, but {', '.join(VIEWS)}{did_you_mean(plain, VIEWS) or '.'}"
        )
    return VIEWS[plain]


def _show(views: Sequence[RqtView]) -> None:
    """Show views that follow the run; without a page, their pictures after a while and at the cell's end."""
    from IPython.display import display

    opened = current_graph().part(OpenViews).by_words
    for view in views:
        key = (view.name, *view.words)
        if key in opened:  # a cell that is run again
            opened.pop(key).close()
        opened[key] = view
    if pace.wanted() == "real":
        for view in views:
            display(view.widget())  # type: ignore[no-untyped-call]  # IPython does not annotate it
        return
    for view in views:
        view.listen()
    if running_nodes() and any(view.listens for view in views):
        wait_for(lambda: False, seconds=SECONDS_WITHOUT_A_PAGE)
        say(f"No page is watching: rqt listened for {SECONDS_WITHOUT_A_PAGE:g} s of robot time.")
    for view in views:
        _show_until_the_end(view)


def _show_until_the_end(view: RqtView) -> None:
    """Show the picture of a view, and again if the rest of its cell changes it."""
    from IPython.core.getipython import get_ipython
    from IPython.display import HTML, display

    before = view.static()
    shown = display(HTML(before), display_id=True)  # type: ignore[no-untyped-call]  # IPython does not annotate it
    shell: Any = get_ipython()

    def end(*_: object) -> None:
        shell.events.unregister("post_run_cell", end)
        if (now := view.static()) != before:
            shown.update(HTML(now))  # type: ignore[no-untyped-call]
        view.stop()

    if shell is None:
        view.stop()
    else:
        shell.events.register("post_run_cell", end)


def _save(file: Path) -> None:
    """Write the open views with their words and the values of their controls."""
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    views: list[RqtView] = [v for v in current_graph().part(OpenViews).by_words.values() if not v.closed]
    about = [
        {"view": view.name, "words": view.words, "controls": {name: view[name] for name in view.controls}}
        for view in views
    ]
    try:
        file.write_text(yaml.safe_dump(about, sort_keys=False, allow_unicode=True), encoding="utf-8")
    except OSError as error:
        raise CourseError(f"Can't write {file}: {error.strerror}. Choose another file.") from error
    say(f"Saved {', '.join(view.name for view in views) or 'no view: none is open'} in {file}.")


def _read(file: Path) -> list[Any]:
    import yaml

    try:
        views = yaml.safe_load(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise CourseError(f"Can't read {file}: {error.strerror}. `%rqt save {file}` writes one.") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise CourseError(f"{file} is not a perspective: {error}") from error
    if not isinstance(views, list) or not all(isinstance(one, dict) for one in views):
        raise CourseError(f"{file} is not a perspective of %rqt: `%rqt save {file}` writes one.")
    return views


def _restored(about: dict[str, Any], file: str) -> list[RqtView]:
    """Create a view from a perspective; print the reason where its words match nothing now."""
    try:
        view_class, words = _view_class(str(about["view"])), [str(word) for word in about.get("words", [])]
        settings = dict(about.get("controls", {}))
    except (KeyError, TypeError, ValueError) as error:
        raise CourseError(f"{file}: {about!r} is not a view: write view, words and controls.") from error
    try:
        view = view_class(current_graph(), words)
    except CourseError as error:
        say(f"{view_class.title} is left out: {error}")
        return []
    view.restore(settings)
    return [view]
