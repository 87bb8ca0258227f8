import errno
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.course import exercise as exercise_module
from course_lib.course.exercise import (
    ask_identity,
    current_identity,
    normalise,
    notebook_text,
    personal_number,
    read_notebook,
    set_identity,
)
from course_lib.errors import CourseError


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / ".course").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("typed", "kept"),
    [
        ("  2023 1234 ", "20231234"),
        ("S-1234", "s-1234"),
        ("٢٠٢٣١٢٣٤", "20231234"),
        ("２０２３", "2023"),  # noqa: RUF001  wide digits, as some keyboards type them
        ("Zoë.M", "zoë.m"),
        ("\u0915\u093e\u092e\u093f\u0932", "\u0915\u093e\u092e\u093f\u0932"),  # with vowels of Devanagari
        ("\u0130rem", "i\u0307rem"),  # Turkish, whose small letter has a combining dot
        ("a\u200d\u0301\u034f\ufe0f", "\u00e1"),
    ],
)
def test_ids_are_normalized_to_one_spelling(typed: str, kept: str) -> None:
    assert normalise(typed) == kept


@pytest.mark.parametrize("typed", ["", "   ", "../etc", "a/b", "a\\b", ".hidden", "x" * 65, "a:b", "a\0b"])
def test_id_unusable_as_folder_name_is_rejected_with_an_example(typed: str) -> None:
    with pytest.raises(CourseError, match="Example: 20231234"):
        normalise(typed)


@pytest.mark.slow
@given(st.text(max_size=80) | st.text("a\u0130\u0301\u0345\u200d\u034f\u00a8\u093f\u0915 ", max_size=12))
def test_normalizing_an_id_is_idempotent(typed: str) -> None:
    try:
        once = normalise(typed)
    except CourseError:
        return
    assert normalise(once) == once


def test_id_is_stored_and_written_into_the_exercises(folder: Path) -> None:
    exercise = folder / "week01_exercise.ipynb"
    exercise.write_text(notebook_text({"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))
    assert "1 exercise" in set_identity(" S1 ")
    assert current_identity() == "s1"
    assert read_notebook(exercise)["metadata"]["course"]["student"] == "s1"


def test_damaged_exercise_does_not_prevent_setting_the_id(folder: Path) -> None:
    (folder / "week01_exercise.ipynb").write_text("{")
    set_identity("s1")
    assert current_identity() == "s1"


def test_unwritable_exercise_is_reported_after_the_id_is_stored(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    exercise = folder / "week01_exercise.ipynb"
    exercise.write_text(notebook_text({"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))

    def fail(path: Path, data: bytes) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    monkeypatch.setattr(exercise_module, "write_atomically", fail)
    with pytest.raises(CourseError, match=r"s1 is stored, but .*week01_exercise\.ipynb cannot be written"):
        set_identity("s1")
    assert current_identity() == "s1"


def test_identity_question_outside_a_notebook_prints_how_to_answer(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ask_identity()
    # The printed command works in a new kernel.
    typed = capsys.readouterr().out.partition("Run: ")[2].replace("your-id", "s2")
    exec(typed, {})
    assert current_identity() == "s2"
    set_identity("s1")
    ask_identity()
    assert "Your ID is s1" in capsys.readouterr().out


def test_personal_values_depend_on_student_and_key_and_use_every_choice() -> None:
    numbers = [personal_number(f"s{i}", "height", 5) for i in range(200)]
    assert set(numbers) == set(range(5))
    assert numbers == [personal_number(f"s{i}", "height", 5) for i in range(200)]
    assert numbers != [personal_number(f"s{i}", "width", 5) for i in range(200)]
    assert personal_number(None, "height", 5) == personal_number("guest", "height", 5)
