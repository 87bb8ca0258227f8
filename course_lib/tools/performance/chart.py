"""A matplotlib picture with words for those who do not see it."""

from base64 import b64encode
from dataclasses import dataclass
from html import escape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Chart:
    """A picture and its alternative text; a cell shows both to those who need them."""

    figure: "Figure"
    alt: str

    def png(self) -> bytes:
        """Give the picture as PNG."""
        file = BytesIO()
        self.figure.savefig(file, format="png", dpi=100, bbox_inches="tight")
        return file.getvalue()

    def save(self, path: str | Path) -> None:
        """Write the picture as a PNG file."""
        Path(path).write_bytes(self.png())

    def _repr_html_(self) -> str:
        data = b64encode(self.png()).decode()
        return f'<img alt="{escape(self.alt)}" src="data:image/png;base64,{data}"/>'
