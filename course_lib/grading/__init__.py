"""Tasks, checks, grading: what a submission is judged by, and where it runs."""

from course_lib.grading.check import check
from course_lib.grading.personal import my_values

__all__ = ["check", "my_values"]
