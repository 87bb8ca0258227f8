import pytest
import yaml

from course_lib.displays.layout import parse_yaml, yaml_text
from course_lib.errors import CourseError

# The value that a scalar is read as, and the scalar that is written for it.
FORMS = {
    "1.0": ("1.0", "1.0"),
    "0x10": ("0x10", "0x10"),
    "yes": ("yes", "yes"),
    "True": ("True", "True"),
    '"true"': ("true", "true"),
    "'1'": ("1", "1"),
    "128; 128; 0": ("128; 128; 0", "128; 128; 0"),
    "<Fixed Frame>": ("<Fixed Frame>", "<Fixed Frame>"),
    "2001-01-01": ("2001-01-01", "2001-01-01"),
    "": (None, "~"),
    "~": (None, "~"),
    "null": (None, "~"),
    '""': ("", '""'),
    '"~"': ("~", '"~"'),
    '"a: b"': ("a: b", '"a: b"'),
    '"two\\nlines"': ("two\nlines", '"two\\nlines"'),
}


@pytest.mark.parametrize("form", FORMS)
def test_every_scalar_is_a_string_or_null_and_is_written_unchanged(form: str) -> None:
    value, written = FORMS[form]
    parsed = parse_yaml(f"key: {form}\n").value
    assert parsed == {"key": value}
    assert yaml_text(parsed) == f"key: {written}\n"


def test_empty_maps_are_written_on_a_separate_line_as_in_rviz() -> None:
    assert yaml_text({"Tree": {}, "List": [{"Tree": {}}]}) == "Tree:\n  {}\nList:\n  - Tree:\n      {}\n"


def test_last_duplicate_key_and_first_document_are_used() -> None:
    assert parse_yaml("a: 1\na: 2\n---\nb: 3\n").value == {"a": "2"}


def test_merge_keys_are_ordinary_keys_and_aliases_are_expanded() -> None:
    assert parse_yaml("a: &x {b: 1}\n<<: *x\n").value == {"a": {"b": "1"}, "<<": {"b": "1"}}


def test_positions_are_lines_and_columns_from_one() -> None:
    places = parse_yaml("a:\n  - b\n  - c: d\n").places
    assert [places[path] for path in (("a",), ("a", 0), ("a", 1, "c"))] == [(2, 3), (2, 5), (3, 8)]


def laughs(form: str) -> str:
    """Ten levels of ten aliases each, in a list or as one key again and again."""
    lines = ["a0: &a0 [x]"]
    for n in range(1, 10):
        inside = ", ".join([form.format(f"*a{n - 1}")] * 10)
        lines.append(f"a{n}: &a{n} " + (f"[{inside}]" if form == "{}" else f"{{{inside}}}"))
    return "\n".join(lines)


@pytest.mark.slow
def test_alias_expansion_is_bounded() -> None:
    with pytest.raises(CourseError, match=r"line \d+, column \d+: with its aliases .* too many values"):
        parse_yaml(laughs("{}"))


def test_repeated_keys_use_no_additional_memory() -> None:
    parsed = parse_yaml(laughs("k: {}"))
    assert len(parsed.places) < 200


def test_deep_nesting_counts_toward_the_limit() -> None:
    with pytest.raises(CourseError, match="too many values"):
        parse_yaml("{a: " * 200 + "[" + "1," * 20_000 + "]" + "}" * 200)


def test_self_referencing_layout_is_rejected() -> None:
    with pytest.raises(CourseError, match="nested too deeply"):
        parse_yaml("a: &a [*a]")


def test_pyyaml_built_without_libyaml_reads_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "a: 1.0\nb: ~\nc: '~'\nd: [x, {e: ''}]\n"
    usual = parse_yaml(text)
    monkeypatch.delattr(yaml, "CBaseLoader")
    assert parse_yaml(text) == usual
