"""Messages of Python in words that do not depend on its version, for comparisons with kept messages."""

import re

# A pattern, and the words of Python 3.11 or of both versions.
CHANGES = (
    # 3.12: the module traceback adds the nearest name; in 3.11 only the interpreter does.
    (r"\. Did you mean: '[\w.]+'\?", ""),
    # 3.13
    (r"(unexpected keyword argument '\w+')\. Did you mean '\w+'\?", r"\1"),
    (r" and no __dict__ for setting new attributes", ""),
    (r"\b(min|max)\(\) iterable argument is empty", r"\1() arg is an empty sequence"),
    # 3.14
    (r"\bfloat division by zero", "division by zero"),
    (
        r"'(?:\w+\.)*(\w+)' object does not support the context manager protocol"
        r"(?: \(missed __\w+__ method\))?",
        r"'\1' object does not support the context manager protocol",
    ),
    (r"cannot use '[\w.]+' as a dict key \((unhashable type: '\w+')\)", r"\1"),
    (
        r"(?<=ValueError: )expected a (?:number in range|nonnegative|positive) [^()]*?(?= \(|\n|;|$)",
        "math domain error",
    ),
    (r"(?<=ValueError: )(?:\S+ is not in list|list\.index\(x\): x not in list)", "x is not in list"),
)


def without_python_version(text: str) -> str:
    """Return output of a program in words that all versions of Python share."""
    for pattern, replacement in CHANGES:
        text = re.sub(pattern, replacement, text)
    # Errors that differ by such words alone are shown once.
    return re.sub(r"^(.+)\n(?:\1\n)+", r"\1\n", text, flags=re.MULTILINE)
