"""Sliders with a name for screen readers: the handles of ipywidgets' have none."""

from pathlib import Path
from typing import Any

import anywidget
import traitlets

_FOLDER = Path(__file__).parent


class Slider(anywidget.AnyWidget):
    """A slider with its name before it, and behind it its value, which may be typed.

    Arrow keys move it by a step. Values outside its limits become the nearest limit.
    """

    _esm = (_FOLDER / "slider.js").read_text("utf-8")
    _css = (_FOLDER / "slider.css").read_text("utf-8")
    description = traitlets.Unicode().tag(sync=True)
    description_width = traitlets.Unicode("auto").tag(sync=True)  # in CSS's units
    value: traitlets.TraitType[Any, Any] = traitlets.Float().tag(sync=True)
    min: traitlets.TraitType[Any, Any] = traitlets.Float().tag(sync=True)
    max: traitlets.TraitType[Any, Any] = traitlets.Float(1.0).tag(sync=True)
    step: traitlets.TraitType[Any, Any] = traitlets.Float(0.01).tag(sync=True)
    decimals = traitlets.Int(3).tag(sync=True)  # of the value that is shown
    is_live = traitlets.Bool(True).tag(sync=True)  # values are sent while somebody drags, not only the last
    disabled = traitlets.Bool(False).tag(sync=True)

    @traitlets.validate("value")
    def _limited(self, proposal: Any) -> Any:
        return max(self.min, min(self.max, proposal["value"]))


class IntSlider(Slider):
    """A slider of whole numbers."""

    value = traitlets.Int().tag(sync=True)
    min = traitlets.Int().tag(sync=True)
    max = traitlets.Int(100).tag(sync=True)
    step = traitlets.Int(1).tag(sync=True)
    decimals = traitlets.Int(0).tag(sync=True)
