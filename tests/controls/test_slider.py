import pytest
from traitlets import TraitError

from course_lib.controls.slider import IntSlider, Slider


@pytest.mark.parametrize(("given", "kept"), [(-9.0, -1.5), (0.123, 0.123), (9, 2.0), (float("inf"), 2.0)])
def test_a_value_beyond_the_limits_becomes_the_nearest_limit(given: float, kept: float) -> None:
    assert Slider(value=given, min=-1.5, max=2.0).value == kept
    slider = Slider(min=-1.5, max=2.0)
    slider.value = given
    assert slider.value == kept


def test_whole_numbers_stay_whole_and_others_floats() -> None:
    assert type(IntSlider(value=3).value) is int
    assert type(Slider(value=1, max=3).value) is float  # as a page sends 1.0
    with pytest.raises(TraitError):
        IntSlider(value=2.5)


def test_whoever_observes_the_value_hears_each_change_once() -> None:
    slider, heard = Slider(max=3), list[float]()
    slider.observe(lambda change: heard.append(change["new"]), "value")
    for value in (1.0, 1.0, 2.5):
        slider.value = value
    assert heard == [1.0, 2.5]
