"""The one exception base of the kit."""


class CourseError(Exception):
    """Something a user can mend: the message names what came in, what was expected and what to do next."""
