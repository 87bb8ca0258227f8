"""Templates of weeks and courses, which `course new` fills."""

from collections.abc import Mapping
from pathlib import Path

HERE = Path(__file__).parent


def template(kind: str, name: str) -> Path:
    """Return a file of a template."""
    return HERE / kind / name


def filled(kind: str, name: str, values: Mapping[str, object]) -> str:
    """Return the text of a template with values in the places of its names."""
    from jinja2 import Environment, StrictUndefined

    text = template(kind, f"{name}.jinja").read_text(encoding="utf-8")
    whole = Environment(undefined=StrictUndefined, keep_trailing_newline=True, autoescape=False)
    return whole.from_string(text).render(**values)
