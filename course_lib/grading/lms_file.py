"""A learning platform's own CSV, of which single cells are changed and every other byte stays."""

import codecs
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from course_lib.errors import CourseError

BOMS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
DELIMITERS = (",", ";", "\t", "|")


@dataclass
class LmsFile:
    """Rows of cells as they are written, with quotes; `ends` holds what follows the last cell of each row."""

    bom: bytes
    encoding: str
    delimiter: str
    rows: list[list[str]]
    ends: list[str]

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a file of any usual encoding, delimiter and line ending.

        Raises:
            CourseError: It can't be read, or holds no table.
        """
        try:
            data = path.read_bytes()
        except OSError as error:
            raise CourseError(f"{path} can't be read: {error.strerror}. Name the platform's CSV.") from error
        bom = next((bom for bom in BOMS if data.startswith(bom)), b"")
        encoding = BOMS.get(bom) or ("utf-8" if _is_utf8(data) else "latin-1")  # latin-1 has all bytes
        try:
            text = data.removeprefix(bom).decode(encoding, "surrogatepass" if bom else "strict")
        except UnicodeError as error:
            raise CourseError(f"{path} is not {encoding}, as it begins: {error}. Export it again.") from error
        first = re.split("[\r\n]", text, maxsplit=1)[0]
        delimiter = max(DELIMITERS, key=first.count)
        if not first.count(delimiter) or "\0" in text:
            raise CourseError(
                f"{path} is no CSV: its first line has no columns. Export it from the platform."
            )
        return cls(bom, encoding, delimiter, *_split(text, delimiter))

    def encoded(self) -> bytes:
        """The whole file again."""
        lines = (self.delimiter.join(row) + end for row, end in zip(self.rows, self.ends, strict=True))
        return self.bom + "".join(lines).encode(self.encoding, "surrogatepass" if self.bom else "strict")

    def text(self, row: int, column: int) -> str:
        """A cell without its quotes; "" where a row is too short."""
        cells = self.rows[row]
        cell = cells[column].strip() if column < len(cells) else ""
        quoted = len(cell) > 1 and cell[0] == cell[-1] == '"'
        return (cell[1:-1].replace('""', '"') if quoted else cell).strip()

    @property
    def headings(self) -> list[str]:
        """The first row."""
        return [self.text(0, place) for place in range(len(self.rows[0]))]

    def put(self, row: int, column: int, number: str) -> None:
        """Change a cell; it keeps its quotes, if it has any."""
        quote = '"' if self.rows[row][column].strip().startswith('"') else ""
        self.rows[row][column] = f"{quote}{number}{quote}"

    def column(self, name: str) -> int:
        """The place of a column, by its heading or by what is before its number, `Week 1 (12345)`.

        Raises:
            CourseError: There is none, or more than one.
        """
        headings = self.headings
        found = [i for i, heading in enumerate(headings) if heading == name]
        found = found or [i for i, h in enumerate(headings) if re.fullmatch(re.escape(name) + r" \(\d+\)", h)]
        if len(found) != 1:
            known = ", ".join(map(repr, headings))
            raise CourseError(f"{len(found) or 'no'} columns are named {name!r}; expected one of {known}")
        return found[0]


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def _split(text: str, delimiter: str) -> tuple[list[list[str]], list[str]]:
    """Rows of raw cells, and each row's line ending; after the last line there is an empty row."""
    d = re.escape(delimiter)
    cells = re.findall(rf'( *"(?:[^"]|"")*"[^{d}\r\n]*|[^{d}\r\n]*)({d}|\r\n|\r|\n|\Z)', text)
    rows, ends = [list[str]()], list[str]()
    for cell, end in cells:
        rows[-1].append(cell)
        if end != delimiter:
            ends.append(end)
            rows.append([])
    return rows[:-1], ends
