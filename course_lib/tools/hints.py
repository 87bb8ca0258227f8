"""What was meant, when a name is not among those that there are."""

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(name: str, there: Iterable[str]) -> str:
    """End a sentence with the nearest name, as ". Did you mean …?", or with "."."""
    close = get_close_matches(name, list(there), n=1, cutoff=0.5)
    return f". Did you mean {close[0]}?" if close else "."
