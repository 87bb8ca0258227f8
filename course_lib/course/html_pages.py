"""HTML pages that nbconvert and JupyterLab's *Save and Export* create from notebooks."""

from html import escape
from typing import Any

from nbconvert.preprocessors import Preprocessor

PNG = "image/png"


class AlternativeTexts(Preprocessor):
    """Give each picture its alternative text.

    A notebook stores it in the metadata of the output, or of the cell for figures of Matplotlib.
    nbconvert's template `lab`, its default, ignores it and describes each picture as *No
    description has been provided for this image*. HTML precedes pictures in all templates, so this
    adds the picture as HTML.
    """

    def preprocess_cell(self, cell: Any, resources: Any, index: int) -> tuple[Any, Any]:
        """Add an `img` element to each output with a picture and its alternative text."""
        for output in cell.get("outputs", ()):
            data, own_text = output.get("data", {}), output.get("metadata", {}).get(PNG, {}).get("alt")
            text = own_text or cell["metadata"].get("alt")
            if text and PNG in data and "text/html" not in data:
                source = f"data:{PNG};base64,{''.join(data[PNG].split())}"
                data["text/html"] = f'<img alt="{escape(text)}" src="{source}">'
        return cell, resources
