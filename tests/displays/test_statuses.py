from course_lib.displays.statuses import Statuses, StatusRow


def test_of_one_name_the_last_word_counts_and_hints_come_last() -> None:
    statuses = Statuses()
    statuses.hint("Topic", "a", "b")
    statuses.set("error", "Topic", "bad")
    statuses.set("ok", "Topic", "OK")
    assert statuses.rows("Marker") == [
        StatusRow("Marker", "Topic", "ok", "OK"),
        StatusRow("Marker", "Topic", "hint", "a"),
        StatusRow("Marker", "Topic", "hint", "b"),
    ]


def test_hints_without_text_take_back_the_last_ones() -> None:
    statuses = Statuses()
    statuses.hint("Topic", "a")
    statuses.hint("Topic")
    assert statuses.rows("Marker") == []


def test_delete_forgets_a_name_and_clear_all() -> None:
    statuses = Statuses()
    for name in ("n/0", "n/1"):
        statuses.set("warn", name, "x")
        statuses.hint(name, "y")
    statuses.delete("n/0")
    assert {row.name for row in statuses.rows("")} == {"n/1"}
    statuses.clear()
    assert statuses.rows("") == []
