"""Nodes that keep the kernel busy, in real JupyterLab: Stop and ■ work, and the line is named."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.jupyterlab import Lab, Notebook, opened

pytestmark = [pytest.mark.browser, pytest.mark.slow]
START = "%load_ext course_lib\nimport time\nimport rclpy\nfrom course_lib import run_live, spin_for\n"
NODES = """from rclpy.node import Node

rclpy.init()

class Stuck(Node):
    def __init__(self):
        super().__init__("stuck")
        self.create_timer(0.1, self.tick)

    def tick(self):
        while True:
            pass

class Stubborn(Stuck):
    def tick(self):
        while True:
            try:
                time.sleep(0.1)
            except:
                pass

class Sleeper(Node):
    def __init__(self):
        super().__init__("sleeper")
        self.create_timer(1.0, self.tick)

    def tick(self):
        time.sleep(1)

class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.create_timer(0.2, lambda: print("spinning"))
"""
ENDLESS = r"cell in\[2\], line 1[12]: (while True|pass)"
BY_STOP, BY_INTERRUPT = "run_live(Stuck())  # Stop", "run_live(Stuck())  # ■"
STUBBORN, SLEEPER = "run_live(Stubborn())", "run_live(Sleeper())"
SPIN, SLEEPY_SPIN = "spin_for(100.0, Stuck())", "spin_for(2.0, Sleeper())"
AWAITED = "await spin_for(1000.0, Talker())"
OVERRUN = "import asyncio\nrun_live(Stuck())\nawait asyncio.sleep(1)"
CELLS = (START, NODES, BY_STOP, BY_INTERRUPT, STUBBORN, SLEEPER, SPIN, SLEEPY_SPIN, AWAITED, OVERRUN)


@pytest.fixture(scope="module")
def notebook(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "busy.ipynb", CELLS) as notebook:
        for source in (START, NODES):
            start(notebook, source)
            notebook.wait_idle()
        yield notebook


def start(notebook: Notebook, source: str) -> Locator:
    """Run one cell, and do not wait for its end."""
    cell = notebook.cell(source)
    notebook.page.evaluate("() => { jupyterapp.commands.execute('notebook:run-cell') }")
    return cell


def interrupt(notebook: Notebook) -> None:
    """Click ■."""
    notebook.page.get_by_title("Interrupt the kernel").click()


def label(cell: Locator) -> Locator:
    return cell.locator(".widget-html-content")


def text(pattern: str) -> re.Pattern[str]:
    return re.compile(pattern, re.IGNORECASE)


def test_stop_button_ends_an_endless_loop_and_reports_its_line(notebook: Notebook) -> None:
    cell = start(notebook, BY_STOP)
    expect(label(cell)).to_have_text(text(rf"running: stuck .* busy for \d+ s in {ENDLESS}"))
    cell.get_by_role("button", name="Stop").click()
    expect(label(cell)).to_have_text(text(rf"stopped: stuck .* interrupted in {ENDLESS}"))
    assert notebook.kernel("print(1 + 1)") == "2\n"


def test_interrupt_button_ends_an_endless_loop_of_a_live_node_between_cells(notebook: Notebook) -> None:
    cell = start(notebook, BY_INTERRUPT)
    expect(label(cell)).to_have_text(text("busy for"))
    interrupt(notebook)
    expect(label(cell)).to_have_text(text(rf"stopped: stuck .* interrupted in {ENDLESS}"))
    assert notebook.kernel("print(1 + 1)") == "2\n"


def test_stop_button_ends_a_loop_that_catches_interrupts(notebook: Notebook) -> None:
    cell = start(notebook, STUBBORN)
    expect(label(cell)).to_have_text(text("busy for"))
    cell.get_by_role("button", name="Stop").click()
    expect(label(cell)).to_have_text(text("stopped: stuck"))


def test_other_cells_run_while_a_callback_sleeps_a_full_period(notebook: Notebook) -> None:
    cell = start(notebook, SLEEPER)
    cell.get_by_text("hint: tick of /sleeper took 1 s").wait_for()
    assert notebook.kernel("print(1 + 1)") == "2\n"
    cell.get_by_role("button", name="Stop").click()
    expect(label(cell)).to_have_text(text("stopped: sleeper"))


def test_busy_line_of_a_cell_is_reported_and_can_be_interrupted(notebook: Notebook) -> None:
    cell = start(notebook, SPIN)
    cell.get_by_text(text(rf"/stuck has been busy for \d+ s in {ENDLESS}")).wait_for()
    interrupt(notebook)
    cell.get_by_text(text(rf"Stopped after 0.1 s of robot time, in {ENDLESS}")).wait_for()
    notebook.wait_idle()


def test_spin_for_ends_although_a_callback_takes_a_full_period(notebook: Notebook) -> None:
    start(notebook, SLEEPY_SPIN)
    notebook.wait_idle()
    assert notebook.kernel("print(1 + 1)") == "2\n"


def test_interrupt_ends_an_awaited_call(notebook: Notebook) -> None:
    cell = start(notebook, AWAITED)
    # JupyterLab shows [*] before the kernel begins with the cell: an interrupt would come too early
    # then.
    cell.get_by_text("spinning").first.wait_for()
    interrupt(notebook)
    cell.get_by_text(text("Stopped after .* of robot time")).wait_for()
    notebook.wait_idle()


def test_interrupt_button_reaches_a_callback_while_a_cell_awaits(notebook: Notebook) -> None:
    cell = start(notebook, OVERRUN)
    expect(label(cell)).to_have_text(text("busy for"))
    interrupt(notebook)
    expect(label(cell)).to_have_text(text("stopped: stuck"))
    notebook.wait_idle()
