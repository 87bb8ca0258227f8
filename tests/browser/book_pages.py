"""List the faults of a book by page: `python -m tests.browser.book_pages BOOK [PICTURES]`."""

import base64
import gzip
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, Locator, Page

from tests.browser.axe import faults
from tests.browser.fake_host import chromium
from tests.patience import PATIENCE

WIDTHS = (1400, 390)  # [px] a desk's and a telephone's
HEIGHT = 900  # [px]
MOST = 1_000_000  # bytes of a page with its scenes and pictures, without the viewer's script
DRAWN = 0.01  # the part of a scene's pixels that is not background, at least
LATEST = 3200  # [px] of one picture
SHARED = "viewer.js"


class Links(HTMLParser):
    """The links, the parts and the anchors of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links, self.parts, self.anchors = list[str](), list[str](), set[str]()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Record the links and ids of a tag."""
        for name, value in attrs:
            if name == "id" and value:
                self.anchors.add(value)
            elif name == "href" and value and tag == "a":
                self.links.append(value)
            elif name in ("src", "data-scene") and value and not value.startswith("data:"):
                self.parts.append(value)


@dataclass(frozen=True)
class Looked:
    """A page at one width: the numbers of all and of playing scenes, and the faults."""

    scenes: int
    recordings: int
    problems: tuple[str, ...]


def pages_of(book: Path) -> list[Path]:
    """Return the pages of a book; themes bring templates along."""
    return [path for path in sorted(book.rglob("*.html")) if "_static" not in path.parts]


def dead_links(book: Path) -> Iterator[str]:
    """Yield each link to a missing file or anchor, and each missing resource."""
    pages = {path: Links(path.read_text("utf-8")) for path in pages_of(book)}
    for path, page in pages.items():
        for link in (*page.links, *page.parts):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                yield f"{path.relative_to(book)}: {link} is not there"
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                yield f"{path.relative_to(book)}: {link} has no such anchor"


def size_of(path: Path) -> int:
    """Return the bytes of a page with its own pictures, scenes and their meshes."""
    parts = {(path.parent / urlsplit(part).path).resolve() for part in Links(path.read_text("utf-8")).parts}
    own = {part for part in parts if part.is_file() and "_static" not in part.parts and part.name != SHARED}
    for scene in [part for part in own if part.parent.name == "_scenes" and part.suffix == ".js"]:
        own |= {scene.with_name(f"{name}.js") for name in meshes_of(scene)}
    return path.stat().st_size + sum(part.stat().st_size for part in own)


def meshes_of(scene: Path) -> set[str]:
    """Return the names of the meshes that a scene shares with others."""
    text = base64.b64decode(scene.read_text("utf-8").split('"')[1])
    return {name.decode() for name in re.findall(rb"mesh-[0-9a-f]{12}", gzip.decompress(text))}


def drawn(host: Locator) -> float:
    """Return the fraction of a scene's pixels that differ from the most frequent color."""
    pixels = np.asarray(Image.open(BytesIO(host.locator("canvas").screenshot())).convert("RGB")).astype(int)
    flat = pixels.reshape(-1, 3)
    kinds, counts = np.unique(flat, axis=0, return_counts=True)
    return float((np.abs(flat - kinds[counts.argmax()]).max(axis=1) > 8).mean())


def look_at(page: Page, path: Path, width: int) -> Looked:
    """Open a page at a width, scroll to each scene, check its pixels, and run axe-core."""
    problems: list[str] = []
    page.set_viewport_size({"width": width, "height": HEIGHT})
    page.goto(path.as_uri())
    page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    hosts = page.locator(".course-scene")
    recordings = 0
    for number in range(hosts.count()):
        host = hosts.nth(number)
        host.scroll_into_view_if_needed()
        host.locator("canvas").wait_for()
        page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        recordings += host.locator(".course-time").count()
        if (part := drawn(host)) < DRAWN:
            problems.append(f"scene {number + 1} is empty: {100 * part:.1f} % of its pixels are drawn")
    wide = page.evaluate("document.documentElement.scrollWidth")
    if wide > width:
        problems.append(f"it is {wide} px wide at {width} px")
    page.add_style_tag(content="* { transition: none !important; animation: none !important }")
    for theme in ("dark", "light"):
        page.evaluate("(theme) => (document.documentElement.dataset.theme = theme)", theme)
        problems += [f"{theme}, at {width} px: {fault}" for fault in faults(page)]
    return Looked(hosts.count(), recordings, tuple(problems))


def opened(browser: Browser, said: list[str]) -> Page:
    """Return a page that notes errors, and requests for anything but files."""
    page = browser.new_page()
    page.set_default_timeout(PATIENCE * 1000)
    page.on("pageerror", lambda error: said.append(f"error: {error}"))
    page.on("requestfailed", lambda request: said.append(f"not loaded: {request.url}"))
    inside = ("file:", "data:", "blob:")
    page.on("request", lambda r: None if r.url.startswith(inside) else said.append(f"request: {r.url}"))
    return page


def picture(page: Page, folder: Path, name: str, width: int) -> None:
    """Keep pictures of a whole page, from top to bottom."""
    page.evaluate("for (const one of document.querySelectorAll('details')) one.open = false")
    height = page.evaluate("document.documentElement.scrollHeight")
    page.set_viewport_size({"width": width, "height": min(height, LATEST)})
    for number, top in enumerate(range(0, height, LATEST)):
        page.evaluate("(top) => scrollTo(0, top)", top)
        page.wait_for_timeout(1000)
        page.screenshot(path=folder / f"{name}_{width}_{number:02}.png")


def main(book: Path, pictures: Path | None = None) -> int:
    """Print a line for each page, and each problem; returns how many problems there are."""
    problems = [*dead_links(book)]
    paths = pages_of(book)
    with chromium() as browser:
        for path in paths:
            name, said, looks = str(path.relative_to(book)), list[str](), list[Looked]()
            for width in WIDTHS:
                page = opened(browser, said)
                looks.append(look_at(page, path, width))
                if pictures:
                    picture(page, pictures, name.replace("/", "_").removesuffix(".html"), width)
                page.close()
            size = size_of(path)
            found = [*said, *(problem for look in looks for problem in look.problems)]
            found += [f"it has {size / 1e6:.2f} MB with its scenes"] if size > MOST else []
            scenes = f"{looks[0].scenes:3} scenes, {looks[0].recordings:3} play"
            sys.stdout.write(f"{name:50} {size / 1000:8.0f} kB {scenes}\n")
            problems += [f"{name}: {problem}" for problem in found]
    sys.stdout.write("\n".join([*problems, f"{len(paths)} pages, {len(problems)} problems", ""]))
    return len(problems)


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:3])) > 0)
