"""A JupyterHub for the tests: the real hub and proxy, and a server for each user."""

import json
import os
import shutil
import signal
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page

from tests.browser.jupyterlab import VIEWPORT, slow_down
from tests.browser.waiting import wait_until
from tests.patience import PATIENCE
from tests.ports import free_ports
from tests.processes import LIMIT_OF_A_SERVER, Program

PROXY = "configurable-http-proxy"
NEEDED = ("jupyterhub", "jupyter_server_proxy", "nbgitpuller")
LIGHT = "api/status"  # of a user's server: a page that costs nothing
TOKEN = "token-of-the-tests"
HURRIED = "grace"  # a user whose server ends kernels that were idle for 20 s, though their page is open
# Run a module as `python -m` does, without what a server of `course lab` leaves out, too: grammars of
# addresses, and yarn's settings. Both take two seconds of each hub and each user's server.
QUICK = """
import runpy, sys
from course_lib.course.jupyterlab import skip_yarn
name = sys.argv.pop(1)
if name == "jupyterhub.singleuser":
    skip_yarn()
runpy.run_module(name, run_name="__main__", alter_sys=True)
"""
SETTINGS = """
c = get_config()
limits = ["cull_idle_timeout=20", "cull_interval=1", "cull_connected=True"]
def hurry(spawner):
    if spawner.user.name == {hurried!r}:
        spawner.args = [*spawner.args, *("--MappingKernelManager." + limit for limit in limits)]
c.Spawner.pre_spawn_hook = hurry
c.JupyterHub.bind_url = "http://127.0.0.1:{ports[0]}/"
c.JupyterHub.hub_port = {ports[1]}
c.ConfigurableHTTPProxy.api_url = "http://127.0.0.1:{ports[2]}"
c.ConfigurableHTTPProxy.command = [{proxy!r}]
c.JupyterHub.authenticator_class = "dummy"
c.Authenticator.allow_all = True
c.JupyterHub.spawner_class = "simple"
c.SimpleLocalProcessSpawner.home_dir_template = {homes!r} + "/{{username}}"
c.Spawner.cmd = [{python!r}, "-c", {quick!r}, "jupyterhub.singleuser"]
c.Spawner.args = ["--allow-root", "--LabApp.expose_app_in_browser=True"]
c.Spawner.start_timeout = c.Spawner.http_timeout = {patience}
c.JupyterHub.services = [{{"name": "tests", "api_token": {token!r}}}]
c.JupyterHub.load_roles = [{{"name": "tests", "services": ["tests"], "scopes": ["access:servers"]}}]
"""


def missing() -> list[str]:
    """List the requirements of a hub that this machine lacks."""
    found = {name: find_spec(name) for name in NEEDED} | {x: shutil.which(x) for x in (PROXY, "git")}
    return [name for name, place in found.items() if place is None]


@dataclass(frozen=True)
class Hub:
    """A running hub.

    Args:
        browser: Where its users look.
        homes: The folder of the users' homes.
        address: Its own, without a slash at the end.
    """

    browser: Browser
    homes: Path
    address: str

    def logged_in(self, user: str) -> Page:
        """Log a user in with a new browser. Return an empty page of it."""
        context = self.browser.new_context(viewport=VIEWPORT)
        context.set_default_timeout(PATIENCE * 1000)
        slow_down(context)
        page = context.new_page()
        page.goto(f"{self.address}/hub/login?next=/hub/spawn/{user}?next=/user/{user}/{LIGHT}")
        page.fill("#username_input", user)
        page.fill("#password_input", "any")
        page.click("#login_submit")
        page.wait_for_url(f"**/user/{user}/**")
        page.close()
        return context.new_page()

    def ask(self, user: str, path: str, method: str = "GET") -> Any:
        """Send a request to a user's server through the proxy, as a service of the hub."""
        headers = {"Authorization": f"token {TOKEN}"}
        request = urllib.request.Request(
            f"{self.address}/user/{user}/api/{path}", None, headers, method=method
        )
        with urllib.request.urlopen(request, timeout=PATIENCE) as response:
            return json.loads(response.read() or "null")


@contextmanager
def running_hub(browser: Browser, folder: Path) -> Iterator[Hub]:
    """Run a hub in a folder, with nothing of it elsewhere, until the end of the block."""
    homes, ports = folder / "homes", free_ports(3)
    homes.mkdir()
    settings = folder / "jupyterhub_config.py"
    given = {"ports": ports, "proxy": shutil.which(PROXY), "homes": str(homes), "token": TOKEN}
    given |= {"hurried": HURRIED, "quick": QUICK}
    settings.write_text(SETTINGS.format(**given, python=sys.executable, patience=round(PATIENCE)))
    command = [sys.executable, "-c", QUICK, "jupyterhub", "-f", str(settings)]
    with open(folder / "hub.log", "wb") as log:
        process = Program(
            command, limit=LIMIT_OF_A_SERVER, cwd=folder, stdout=log, stderr=log, start_new_session=True
        )
    address = f"http://127.0.0.1:{ports[0]}"
    try:
        wait_until(lambda: _answers(f"{address}/hub/health") or process.poll() is not None)
        assert process.poll() is None, (folder / "hub.log").read_text()
        yield Hub(browser, homes, address)
    finally:
        process.send_signal(signal.SIGTERM)  # it ends its users' servers and its proxy
        with suppress(subprocess.TimeoutExpired):
            process.wait(PATIENCE)
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)


def _answers(url: str) -> bool:
    with suppress(OSError), urllib.request.urlopen(url, timeout=PATIENCE) as response:
        return bool(response.status == 200)
    return False
