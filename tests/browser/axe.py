"""Faults that axe-core, the engine of browsers' accessibility checks, finds in a page."""

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page


def faults(page: Page, within: str = "html") -> list[str]:
    """List the faults that axe-core calls serious or critical: rule, reason and element."""
    options = {"preload": not page.url.startswith("file:")}  # it would ask for style sheets anew
    found = Axe().run(page, context=within, options=options).response["violations"]
    return [
        f"{fault['id']}: {fault['help']}: {node['html'][:200]}"
        for fault in found
        if fault["impact"] in ("serious", "critical")
        for node in fault["nodes"]
    ]
