import pytest
from traitlets import TraitError

from course_lib.controls import IntSlider, Slider, slider


@pytest.mark.parametrize(("given", "kept"), [(-9.0, -1.5), (0.123, 0.123), (9, 2.0), (float("inf"), 2.0)])
def test_value_beyond_the_limits_is_clamped(given: float, kept: float) -> None:
    assert Slider(value=given, min=-1.5, max=2.0).value == kept
    slider = Slider(min=-1.5, max=2.0)
    slider.value = given
    assert slider.value == kept


def test_int_slider_accepts_only_integers_and_slider_gives_floats() -> None:
    assert type(IntSlider(value=3).value) is int
    assert type(Slider(value=1, max=3).value) is float  # as a page sends 1.0
    with pytest.raises(TraitError):
        IntSlider(value=2.5)


def test_value_observers_are_called_once_per_change() -> None:
    slider, received = Slider(max=3), list[float]()
    slider.observe(lambda change: received.append(change["new"]), "value")
    for value in (1.0, 1.0, 2.5):
        slider.value = value
    assert received == [1.0, 2.5]


def test_slider_callback_gets_the_initial_and_each_new_value() -> None:
    values: list[float] = []

    def on_change(value: float) -> str:
        values.append(value)
        return f"twice is {2 * value:.1f}"

    box = slider("yaw [°]", -180.0, 180.0, on_change, value=90.0, step=15.0)
    chosen, label = box.children
    assert (values, label.value, chosen.description) == ([90.0], "twice is 180.0", "yaw [°]")
    chosen.value = 400.0
    assert (values, label.value) == ([90.0, 180.0], "twice is 360.0")
    assert slider("z", 0.0, 2.0, lambda value: None).children[1].value == ""


def test_page_without_widgets_describes_a_slider_in_words() -> None:
    data = slider("z [m]", 0.0, 1.5, lambda value: None)._repr_mimebundle_()
    assert data["text/plain"] == "A slider was here: z [m], from 0 to 1.5. Run this cell to use it."
    assert "application/vnd.jupyter.widget-view+json" in data
