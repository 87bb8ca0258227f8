from course_lib.displays.statuses import Statuses, StatusRow, StatusTable


def test_last_status_of_an_entry_replaces_the_former_and_hints_are_listed_last() -> None:
    statuses = Statuses()
    statuses.hint("Topic", "a", "b")
    statuses.set("error", "Topic", "bad")
    statuses.set("ok", "Topic", "OK")
    assert statuses.rows("Marker") == [
        StatusRow("Marker", "Topic", "ok", "OK"),
        StatusRow("Marker", "Topic", "hint", "a"),
        StatusRow("Marker", "Topic", "hint", "b"),
    ]


def test_empty_hints_clear_the_previous_ones() -> None:
    statuses = Statuses()
    statuses.hint("Topic", "a")
    statuses.hint("Topic")
    assert statuses.rows("Marker") == []


def test_delete_removes_one_status_and_clear_removes_all() -> None:
    statuses = Statuses()
    for name in ("n/0", "n/1"):
        statuses.set("warn", name, "x")
        statuses.hint(name, "y")
    statuses.delete("n/0")
    assert {row.name for row in statuses.rows("")} == {"n/1"}
    statuses.clear()
    assert statuses.rows("") == []


ROWS = [
    StatusRow("Marker", "Topic", "ok", "1 messages received"),
    StatusRow("Marker", "n/0", "error", "<b>Frame</b> & co"),
    StatusRow("Marker", "n/0", "hint", "say this"),
    StatusRow("Grid", "Transform", "warn", "hm"),
]


def test_status_table_marks_levels_with_icons_and_words() -> None:
    html = StatusTable(ROWS)._repr_html_()
    for mark in ("✔ Ok", "✖ Error", "⚠ Warn", "➤ hint"):
        assert mark in html
    assert "<th>Level</th>" in html


def test_status_texts_are_escaped_in_html() -> None:
    assert "<b>Frame" not in StatusTable(ROWS)._repr_html_()
    assert "&lt;b&gt;Frame&lt;/b&gt; &amp; co" in StatusTable(ROWS)._repr_html_()


def test_columns_are_aligned_in_a_terminal() -> None:
    lines = str(StatusTable(ROWS)).splitlines()
    assert lines[0] == "Marker  Topic      ✔ Ok     1 messages received"
    assert lines[3] == "Grid    Transform  ⚠ Warn   hm"
    assert str(StatusTable()) == ""


def test_ambiguous_rviz_status_has_a_tooltip() -> None:
    html = StatusTable([StatusRow("Marker", "Array Topic", "ok", "OK")])._repr_html_()
    assert "title=\"RViz's Marker display also subscribes to arrays" in html


def test_status_with_a_very_long_name_and_text_is_shortened() -> None:
    statuses = Statuses()
    statuses.set("error", "n" * 10_000_000, "begin" + "x" * 10_000_000 + "end")
    (row,) = statuses.rows("Marker")
    assert len(row.name) + len(row.text) < 10_000
    assert row.text.startswith("begin")
    assert row.text.endswith("end")
