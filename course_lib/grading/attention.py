"""What an instructor must see before marks go out: in the terminal, and on top of the index."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from course_lib.errors import counted
from course_lib.grading.handin.copies import Alike, alike_in
from course_lib.grading.handin.ids import MISMATCH, NO_ID, UNVERIFIED

NAMED = 5  # names in one line; the index has all
SIMILAR = "similar code"
ADVICE = {
    MISMATCH: "marked, but not exported before you have looked. Wrong folder: move the file and grade again. "
    "Otherwise accept it by a mark: course mark OUT STUDENT EXERCISE TASK POINTS. "
    "Folders that are not named after IDs: course collect with --roster",
    NO_ID: "the files name no student; judged as who handed in, or as a guest if no roster says who",
    UNVERIFIED: "only the files say whose they are; collect with --roster to have it compared",
    SIMILAR: "to be read side by side in",
}


@dataclass(frozen=True)
class Flag:
    """Some words on a submission, and the page that shows more, or ""."""

    kind: str
    text: str
    link: str = ""


@dataclass(frozen=True)
class Concern:
    """A kind of thing to look at, with pages in OUT/reports that show more."""

    text: str
    pages: tuple[str, ...] = ()

    def line(self, out: Path) -> str:
        """Return it for the terminal."""
        return " ".join([self.text, ", ".join(str(out / "reports" / page) for page in self.pages)]).rstrip()


def flags(result: Mapping[str, Any], alike: Mapping[tuple[str, str], Alike]) -> list[Flag]:
    """Return what to look at in one result."""
    word = result.get("id_flag")
    found = [Flag(word, word)] if word else []
    if similar := alike.get((result["student"], result["exercise"])):
        found.append(Flag(SIMILAR, f"{SIMILAR}: {_some(similar.others)}", similar.link))
    return found


def concerns(results: Iterable[Mapping[str, Any]], out: Path) -> list[Concern]:
    """Return each kind of thing to look at, with those whom it concerns."""
    alike, who, pages = alike_in(out), defaultdict[str, list[str]](list), set[str]()
    for result in results:
        for flag in flags(result, alike):
            who[flag.kind].append(f"{result['student']} {result['exercise']}")
            pages |= {flag.link.split("#")[0]} - {""}
    return [
        Concern(
            f"{kind}: {counted(len(who[kind]), 'submission')} ({_some(who[kind])}): {advice}",
            tuple(sorted(pages)) if kind == SIMILAR else (),
        )
        for kind, advice in ADVICE.items()
        if kind in who
    ]


def _some(names: Sequence[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
