"""The kit's own interface files, each read when one of its types is first looked up."""

from collections.abc import Iterator, MutableMapping
from pathlib import Path
from typing import Any

from course_lib.ros.messages.interface_files import names_in, read_defaults, read_interface


class LazyTypes(MutableMapping[str, Any]):
    """Types by name, for rosbags' store: those given, and those of all files in a folder of packages.

    A file takes milliseconds to parse and there are hundreds of them; a program needs a few.

    Args:
        known: Types that were read before.
        folder: Of packages with files.
        defaults: Gets the default values in a file, by type and field.
    """

    def __init__(self, known: dict[str, Any], folder: Path, defaults: dict[tuple[str, str], Any]) -> None:
        self._known, self._defaults = known, defaults
        self._files = {name: path for path in folder.glob("*/*/*.*") for name in names_in(path)}

    def __getitem__(self, name: str) -> Any:
        if name not in self._known and name in self._files:
            self._known |= read_interface(self._files[name])
            self._defaults |= read_defaults(self._files[name])
        return self._known[name]

    def __setitem__(self, name: str, fields: Any) -> None:
        self._known[name] = fields

    def __delitem__(self, name: str) -> None:
        del self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in self._known or name in self._files

    def __iter__(self) -> Iterator[str]:
        yield from dict.fromkeys((*self._known, *self._files))

    def __len__(self) -> int:
        return len(self._known.keys() | self._files.keys())
