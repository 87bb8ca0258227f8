"""Views that were there before their widgets, while JupyterLab restores a page."""

import pytest
from playwright.sync_api import Browser

from course_lib.viewer import html

pytestmark = pytest.mark.browser

# A widget is made while JupyterLab restores a page, or after it. A view without a model asks at
# each rendering: is the manager restored? The timer ends once before that, then runs until no new
# one is set.
RESTORE = """async ([code, isRestored]) => {
    const address = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
    const { default: module } = await import(address);
    const timers = [], states = [];
    window.setTimeout = (action) => timers.push(action);
    class Manager { get restoredStatus() { return isRestored; } }
    const widget_manager = Object.assign(new Manager(), { get_model: () => new Promise(() => 0) });
    widget_manager.restored = { emit: () => states.push(widget_manager.restoredStatus) };
    module.initialize({ model: { widget_manager, on() {}, off() {}, get() {} } });
    timers.splice(0).forEach((action) => action());
    if (!isRestored) { isRestored = true; widget_manager.restored.emit(); }
    while (timers.length) timers.splice(0).forEach((action) => action());
    return states; }"""


@pytest.mark.parametrize(("is_restored", "states"), [(True, [True]), (False, [False, False, False, True])])
def test_views_wait_for_late_models_after_a_slow_page_restore(
    browser: Browser, is_restored: bool, states: list[bool]
) -> None:
    page = browser.new_page()
    assert page.evaluate(RESTORE, [html.widget_module(), is_restored]) == states
    page.close()
