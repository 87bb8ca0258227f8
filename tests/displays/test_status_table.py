from course_lib.displays.status_table import StatusTable, table
from course_lib.displays.statuses import StatusRow

ROWS = [
    StatusRow("Marker", "Topic", "ok", "1 messages received"),
    StatusRow("Marker", "n/0", "error", "<b>Frame</b> & co"),
    StatusRow("Marker", "n/0", "hint", "say this"),
    StatusRow("Grid", "Transform", "warn", "hm"),
]


def test_the_table_tells_levels_by_icon_and_word_and_not_by_colour_only() -> None:
    html = table(ROWS)
    for mark in ("✔ Ok", "✖ Error", "⚠ Warn", "➤ hint"):
        assert mark in html
    assert "<th>Level</th>" in html


def test_texts_cannot_become_html() -> None:
    assert "<b>Frame" not in table(ROWS)
    assert "&lt;b&gt;Frame&lt;/b&gt; &amp; co" in table(ROWS)


def test_in_a_terminal_the_columns_are_aligned() -> None:
    lines = str(StatusTable(ROWS)).splitlines()
    assert lines[0] == "Marker  Topic      ✔ Ok     1 messages received"
    assert lines[3] == "Grid    Transform  ⚠ Warn   hm"
    assert str(StatusTable()) == ""
