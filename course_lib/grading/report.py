"""One page per student and exercise: the mark, the reasons, and their scenes to turn around."""

from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from course_lib.grading.ghost import expected
from course_lib.grading.judge import Run, TaskResult
from course_lib.grading.result import Result
from course_lib.grading.store import write_whole
from course_lib.grading.table import result_html, rows
from course_lib.grading.task import Task
from course_lib.recording import Recording

MAX_OUTPUT = 20_000  # characters
MAX_SCENE = 60_000  # characters of a scene: all of them and the one copy of the viewer stay under 1 MB
PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ font-family: sans-serif; max-width: 60em; margin: 1em auto; padding: 0 1em; line-height: 1.4 }}
pre {{ background: #f3f3f3; padding: 0.5em; overflow: auto; max-height: 20em; white-space: pre-wrap }}
.scenes {{ display: flex; gap: 1em }} figure {{ flex: 1; margin: 0 }}
</style>
<h1>{title}</h1>
{body}
{script}
</html>
"""


def write_report(result: Result, out: Path) -> Path:
    """Write OUT/reports/STUDENT/EXERCISE.html; everything that comes from students is escaped."""
    from course_lib.viewer.html import bundle_script

    submission = result.submission
    path = out / "reports" / submission.student / f"{submission.exercise}.html"
    title = escape(f"{submission.exercise}: {submission.student}")
    body = "\n".join([*_head(result), *_tasks(result), *_output(result)])
    page = PAGE.format(title=title, body=body, script=bundle_script() if "course-scene" in body else "")
    write_whole(path, page.encode("utf-8", "replace"))
    return path


def _head(result: Result) -> Iterator[str]:
    received, mark = result.submission.received, result.mark
    if mark is None:
        yield f"<p>Not marked ({escape(result.status)}): {escape(result.message)}</p>"
        return
    yield f"<p><strong>{mark.final:g} of {mark.max_score:g} points.</strong> {escape(result.message)}.</p>"
    late = f"{mark.days_late} day(s) late: {mark.penalty:g} points off {mark.score:g}"
    when = f"Received {received.time:%Y-%m-%d %H:%M %Z} ({escape(received.source)})"
    yield f"<p>{when}, {late if mark.days_late else 'in time'}.</p>"
    if result.reason:
        yield f"<p>Stopped at a limit ({escape(result.reason)}): what was done by then counts.</p>"


def _tasks(result: Result) -> Iterator[str]:
    if result.run is None:
        return
    for task, marks in zip(result.run.tasks, result.run.results, strict=True):
        bonus = ", on top" if marks.bonus else ""
        headline = f"{marks.score:g} of {marks.points:g} points{bonus}"
        yield f"<h2>{escape(marks.title)}</h2>"
        yield result_html(headline, marks.errors, rows(marks.checks), _for_a_person(marks))
        runs = [run for run in result.run.runs if run.evidence.task == task.id and not run.hidden]
        yield from _scenes(task, runs)


def _for_a_person(marks: TaskResult) -> list[str]:
    return [] if marks.checks else ["A person reads and marks this task."]


def _scenes(task: Task, runs: Sequence[Run]) -> Iterator[str]:
    """What was published in the public scenario, beside what was expected."""
    if not runs or not runs[0].evidence.samples:
        return
    evidence = runs[0].evidence
    figures = [_figure(evidence.recording, "yours")]
    if task.ghost:
        figures.append(_figure(expected(task, evidence.personal), "expected"))
    yield f'<div class="scenes">{"".join(figures)}</div>'


def _figure(recording: Recording, caption: str) -> str:
    from course_lib.displays.render import scene_of
    from course_lib.viewer.html import scene_fragment

    try:
        view = scene_fragment(scene_of(recording), label=caption)
    except Exception as error:  # what students publish may be anything; the reasons matter more than the view
        view = f"<p>This scene can't be drawn: {escape(str(error))}</p>"
    if len(view) > MAX_SCENE:
        view = "<p>This scene is too large for the report.</p>"
    return f"<figure>{view}<figcaption>{caption}</figcaption></figure>"


def _output(result: Result) -> Iterator[str]:
    if result.run is None:
        return
    if result.run.cell_errors:
        errors = "".join(f"<li><code>{escape(error)}</code></li>" for error in result.run.cell_errors)
        yield f"<h2>Errors in cells</h2><ul>{errors}</ul>"
    if result.run.log.output:
        yield f"<h2>Output</h2><pre>{escape(result.run.log.output[:MAX_OUTPUT])}</pre>"
