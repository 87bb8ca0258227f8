"""The catalogs that come with the installation."""

from functools import lru_cache

from course_lib.course.files import exercises_dir, solutions_dir
from course_lib.grading.catalog import Catalog, load_catalog


@lru_cache(maxsize=1)
def shipped_catalog() -> Catalog:
    """The public tasks: what students have."""
    return load_catalog(exercises_dir())


@lru_cache(maxsize=1)
def full_catalog() -> Catalog:
    """Public and hidden: instructors only.

    Raises:
        CourseError: This installation holds no solutions.
    """
    return load_catalog(exercises_dir(), solutions_dir())
