"""Sphinx's settings of the kit's own book; `course book OUT` builds it."""

from course_lib.book.settings import *  # noqa: F403
