"""Messages of newer Pythons in the words of Python 3.11, which tables of expected messages have."""

import re

# A pattern of a newer Python, and its replacement.
CHANGES = (
    # Since 3.12 the module traceback adds the nearest name; in 3.11 only the interpreter does.
    (r"\. Did you mean: '[\w.]+'\?", ""),
    # Since 3.13.
    (r"(unexpected keyword argument '\w+')\. Did you mean '\w+'\?", r"\1"),
    (r" and no __dict__ for setting new attributes", ""),
    (r"\b(min|max)\(\) iterable argument is empty", r"\1() arg is an empty sequence"),
)


def as_in_python_3_11(text: str) -> str:
    """Return output of a program with the messages that Python 3.11 writes."""
    for pattern, replacement in CHANGES:
        text = re.sub(pattern, replacement, text)
    return text
