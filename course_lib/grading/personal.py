"""Values that depend on the student, so that copying an answer is of no use."""

from collections.abc import Mapping
from typing import Any

from course_lib.course.identity import current_identity, personal_number
from course_lib.errors import CourseError
from course_lib.grading.run.outcome import plain
from course_lib.grading.task import Message, Task, resolve

_given: dict[str, dict[str, Any]] | None = None  # set in the grader's worker, which holds no check files


def personal_values(task: Task, student: str | None) -> dict[str, Any]:
    """Choose one option of each row of a task's table, by a hash of the student's normalised ID."""
    return {
        name: plain(options[personal_number(student, f"{task.id}/{name}", len(options))])
        for name, options in task.personal.items()
    }


def my_values(task_id: str) -> Mapping[str, Any]:
    """Return your own values of a task, by name: `my_values("week01.post")["height"]`.

    They depend on your student ID. Without one they are those of a guest.

    Args:
        task_id: The task, "week01.post".

    Raises:
        CourseError: There is no such task.
    """
    if _given is not None:
        if task_id not in _given:
            raise CourseError(f"there is no task {task_id!r} in this exercise, only {', '.join(_given)}")
        return _given[task_id]
    from course_lib.grading.catalog import shipped_catalog

    return personal_values(shipped_catalog().task(task_id), current_identity())


def give_values(values: dict[str, dict[str, Any]]) -> None:
    """Set the values of `my_values`, by task, in the worker that runs a submission."""
    global _given
    _given = values


def build(message: Message, personal: Mapping[str, Any]) -> Any:
    """Build the ROS message of an input, with the student's own values in it.

    Raises:
        CourseError: A field is unknown or its value does not fit; names topic and reason.
    """
    from course_lib.ros.messages import message_class
    from course_lib.ros.messages.conversions import set_fields

    made = message_class(message.type_name)()
    try:
        set_fields(made, resolve(message.fields, personal))
    except (AssertionError, AttributeError, TypeError, ValueError) as error:  # what ROS raises for a misfit
        raise CourseError(f"the message for {message.topic} ({message.type_name}): {error}") from error
    return made
