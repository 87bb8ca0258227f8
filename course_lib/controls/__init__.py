"""Controls that ipywidgets does not provide: a slider with a label for screen readers."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import anywidget
import traitlets
from ipywidgets import Label, VBox

_FOLDER = Path(__file__).parent
# The class of elements whose content JupyterLab's extension saves as HTML with the notebook.
SAVED_AS_HTML = "course-html"


class Slider(anywidget.AnyWidget):
    """A slider with its name on the left, and on the right its value, which can be edited.

    Arrow keys move it by a step. Values outside its limits become the nearest limit.
    """

    _esm = (_FOLDER / "slider.js").read_text("utf-8")
    _css = (_FOLDER / "slider.css").read_text("utf-8")
    description = traitlets.Unicode().tag(sync=True)
    # A CSS length.
    description_width = traitlets.Unicode("auto").tag(sync=True)
    value: traitlets.TraitType[Any, Any] = traitlets.Float().tag(sync=True)
    min: traitlets.TraitType[Any, Any] = traitlets.Float().tag(sync=True)
    max: traitlets.TraitType[Any, Any] = traitlets.Float(1.0).tag(sync=True)
    step: traitlets.TraitType[Any, Any] = traitlets.Float(0.01).tag(sync=True)
    # Decimals of the displayed value.
    decimals = traitlets.Int(3).tag(sync=True)
    # Whether values are sent while the handle is dragged, or only when it is released.
    is_live = traitlets.Bool(True).tag(sync=True)
    disabled = traitlets.Bool(False).tag(sync=True)

    @traitlets.validate("value")
    def _clip(self, proposal: Any) -> Any:
        return max(self.min, min(self.max, proposal["value"]))


class IntSlider(Slider):
    """A slider for integers."""

    value = traitlets.Int().tag(sync=True)
    min = traitlets.Int().tag(sync=True)
    max = traitlets.Int(100).tag(sync=True)
    step = traitlets.Int(1).tag(sync=True)
    decimals = traitlets.Int(0).tag(sync=True)


class ControlBox(VBox):  # type: ignore[misc]  # ipywidgets has no types
    """A column of controls that is still readable after its kernel has ended.

    When JupyterLab saves the notebook, its extension of this kit adds the values as HTML. Pages
    that have neither widgets nor this HTML show a text.

    Args:
        children: The controls.
        describe: Returns the text.
    """

    def __init__(self, children: Sequence[Any], describe: Callable[[], str]) -> None:
        super().__init__(children)
        self._describe = describe
        self.add_class(SAVED_AS_HTML)

    def _repr_mimebundle_(self, **kwargs: Any) -> dict[str, Any]:
        data: dict[str, Any] = super()._repr_mimebundle_(**kwargs)
        return data | {"text/plain": self._describe()}


def slider(
    description: str,
    low: float,
    high: float,
    on_change: Callable[[float], object],
    *,
    value: float | None = None,
    step: float | None = None,
) -> ControlBox:
    """Return a slider for the last line of a cell. The callback's return value is shown below it.

    The callback is called once with the initial value, and again whenever the slider is moved.

    Args:
        description: The slider's name, with the unit.
        low: The minimum.
        high: The maximum.
        on_change: Called with the value.
        value: The initial value; None for the middle of the range.
        step: The change by an arrow key; None for a hundredth of the range.
    """
    control = Slider(
        value=(low + high) / 2 if value is None else value,
        min=low,
        max=high,
        step=step or (high - low) / 100,
        decimals=2 if step is None or step % 1 else 0,
        description=description,
        description_width="10em",
        layout={"width": "34em", "max_width": "100%"},
    )
    label = Label()

    def show(new: float) -> None:
        text = on_change(new)
        label.value = "" if text is None else str(text)

    control.observe(lambda change: show(change["new"]), "value")
    show(control.value)
    limits = f"from {low:g} to {high:g}"
    text = f"A slider was here: {description}, {limits}. Run this cell to use it."
    return ControlBox([control, label], lambda: text)
