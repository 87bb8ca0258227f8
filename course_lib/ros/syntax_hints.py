"""Hints for syntax errors: the cause that Python's own message does not explain to a beginner.

A hint is found by the parser's message and the line at which the parser stops. Typical causes are
text from web pages, chats and C++, decimal commas, and commands of a terminal.
"""

import keyword
import linecache
import re
import sys
import tomllib
import unicodedata
from itertools import pairwise
from pathlib import Path

# A pattern for the line at which the older parser stops, and the newer rule that allows it.
_NEWER = (
    (r"^\s*type\s+\w+", "`type NAME = …` names a type"),
    (
        r"^\s*(async\s+def|def|class)\s+\w+\s*\[",
        "there are type parameters, as in `def f[T](x: T)`",
    ),
)
_F_STRING = r"(?<!\w)([rR][fF]|[fF][rR]?)[\"']"
# Errors of an older Python for quotes in a field that end the f-string, for a backslash in a field,
# and for a line break after a bracket or an operator. Other errors in such a line have other
# causes.
_NEWER_FIELD = r"f-string: (unmatched '[(\[{]'|expecting '}')|f-string expression part cannot include"
_OPEN_FIELD = r"\{[^}\"']*(?<=[-+*/,(\[{])\s*$"
# The grammar is read on import, because a program may later use up all file handles.
_TABLES: dict[str, list[list[str]]] = tomllib.loads(
    Path(__file__).with_name("syntax_hints.toml").read_text("utf-8")
)
# Two numbers without a space, but not three of them.
_DECIMAL_COMMA = re.compile(r"(?<![\w.,])-?\d+,\d+(?!\w|\.|,\d)")


def syntax_hint(error: SyntaxError) -> str:
    """Return the hint for a syntax error, or "" if Python's message needs no explanation."""
    message = error.msg or ""
    # IPython compiles a syntax tree. Its scope errors do not contain the line.
    line = error.text or linecache.getline(error.filename or "", error.lineno or 0)
    if message.startswith("invalid character '·'") and re.search(r"\d·\d", line):
        return "a decimal number has a point, 0.5: instead of · write the point of the keyboard."
    if found := re.match(r"invalid character '(.)'", message):
        return _character_hint(found[1])
    if re.match(r"invalid non-printable character", message):
        return (
            "the line has an invisible or unusual character, as in text from a web page: type the line again."
        )
    if newer := newer_python_hint(error):
        return newer
    is_split = message.startswith("positional argument follows") or "after dictionary key" in message
    if is_split and (found_comma := decimal_comma_hint(line)):
        return found_comma
    if _is_prose(line) and not message.startswith("Missing parentheses"):
        return "this line is text and not code: delete it, or begin it with # as a comment."
    # The parser stops one line later where C and Java open a block, or where a class has no ( ).
    before = linecache.getline(error.filename, error.lineno - 1) if error.filename and error.lineno else ""
    return _hint_in_table("before", message, before) or _hint_in_table("lines", message, line)


_WORD = r"\(?[A-Za-z]+(?:['\u2019][a-z]+)?[.,:!?)]*"


def _is_prose(line: str) -> bool:
    """Return whether a line is an English sentence, like "Sure! Here is the corrected function:".

    In code, two words that are not keywords never follow each other.
    """
    text = line.partition("#")[0]
    words = text.split()
    if re.search(r"[=\[\]{}<>;]|\w\(", text) or len(words) < 3:
        return False
    if words[0] == "foreach" or not re.match(r"[(\w-]", words[0]):
        return False
    is_statement = words[0] in {*keyword.kwlist, "print"}
    if is_statement and not text.rstrip().endswith((".", "!")):
        return False
    plain = [re.fullmatch(_WORD, word) is not None for word in words]
    # Words separated by commas also occur in code.
    pairs = sum(
        re.fullmatch(_WORD, second) is not None
        and first.isalpha()
        and not {first, second.rstrip(".,:!?")} & {*keyword.kwlist}
        for first, second in pairwise(words)
    )
    is_sentence = all(plain) and len(words) > 3 and "," not in text
    return pairs >= (1 if is_sentence else 2) and sum(plain) >= 0.7 * len(words)


def _hint_in_table(table: str, message: str, line: str) -> str:
    for text, pattern, hint in _TABLES[table]:
        if re.search(text, message) and (match := re.search(pattern, line)):
            return hint.format(match[0], *match.groups())
    return ""


def decimal_comma_hint(line: str) -> str:
    """Return the hint for a number like 0,5 in a line that failed, or ""."""
    found = _DECIMAL_COMMA.search(line)
    if found is None:
        return ""
    return f"a decimal number has a point, 0.5. With a comma, as in {found[0]}, these are two numbers."


def _character_hint(character: str) -> str:
    meant = next((text for signs, text in _TABLES["characters"] if character in signs), "")
    # Full-width characters of East Asian keyboards have a plain form.
    plain = unicodedata.normalize("NFKC", character)
    value = unicodedata.numeric(character, None)
    if not meant and value is not None and not plain.isascii():
        # A fraction like ½, or a digit that is not ASCII.
        meant = f"{value:g}, with the digits 0 to 9"
    if not meant and plain.isascii() and len(plain) == 1:
        meant = f"{plain}, with the keyboard set to English"
    instead = f"instead of {character} write {meant}."
    return instead if meant else f"the code cannot contain {character}: delete it."


def newer_python_hint(error: SyntaxError) -> str:
    """Return a hint about the syntax of Python 3.12 that a line may use, or "".

    From Python 3.12 on it is always "".
    """
    if sys.version_info >= (3, 12):
        return ""
    line, message = error.text or "", error.msg or ""
    if "expecting '}'" in message and line.count("{") != line.count("}"):
        return ""
    is_field = re.match(_NEWER_FIELD, message) or (
        message.startswith("unterminated string") and re.search(_OPEN_FIELD, line)
    )
    if is_field and re.search(_F_STRING, line):
        rule: str | None = "an f-string may have quotes, backslashes and line breaks in braces"
    else:
        rule = next((rule for pattern, rule in _NEWER if re.search(pattern, line)), None)
    if rule is None:
        return ""
    here = ".".join(map(str, sys.version_info[:2]))
    return (
        f"in Python 3.12, which ROS 2 Jazzy has, {rule}. Here Python {here} runs: install the kit "
        "with Python 3.12, or write the line for both."
    )


# Letters of other alphabets that look like Latin ones.
_LOOK_ALIKES = "аеорсухіјѕԁһАВЕКМНОРСТУХІЈЅΑΒΕΖΗΙΚΜΝΟΡΤΥΧο"  # noqa: RUF001


def foreign_letter(text: str) -> str:
    """Return a sentence about a word that mixes Latin letters with one that looks Latin, or ""."""
    for word in re.findall(r"\w+", text):
        foreign = next((letter for letter in word if letter in _LOOK_ALIKES), "")
        if foreign and re.search("[A-Za-z]", word):
            alphabet = unicodedata.name(foreign).partition(" ")[0].capitalize()
            return f"the letter {foreign} in {word} is {alphabet} and only looks like a Latin one"
    return ""
