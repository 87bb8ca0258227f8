"""The environment of this process: a kernel, a JupyterHub, and access to the user's browser."""

import getpass
import os
import sys
import webbrowser
from collections.abc import Mapping
from html import escape
from importlib.util import find_spec
from typing import Any

from course_lib.errors import CourseError


def user_name() -> str:
    """Return the login name of the user, or "user1234" for a user with a number only.

    In containers of OpenShift and on some hubs, the user has no entry in the machine's list.
    """
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return f"user{os.getuid()}"


def in_notebook() -> bool:
    """Return whether this code runs in a notebook's kernel."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


def running_cell() -> tuple[str, str] | None:
    """Return the id of the running cell and of this run of it; None if the page sends no ids."""
    ipython = sys.modules.get("IPython")
    shell = ipython and ipython.get_ipython()
    parent: dict[str, Any] = getattr(shell, "get_parent", dict)() or {}
    cell = parent.get("metadata", {}).get("cellId")
    return (str(cell), str(parent["header"]["msg_id"])) if cell else None


def send_to_page(target: str, data: Mapping[str, Any]) -> None:
    """Send data to the kit's extension of JupyterLab if this code runs in a notebook's kernel.

    Args:
        target: The name of the comm target that the extension has registered.
        data: The data, which can be written as JSON.
    """
    if in_notebook():
        from ipykernel.comm import Comm

        Comm(target_name=target, data=dict(data)).close()  # type: ignore[no-untyped-call]  # has no types


def hub_prefix() -> str | None:
    """Return the path of the user's server on a JupyterHub, like "/user/ada/"; None without a hub."""
    return os.environ.get("JUPYTERHUB_SERVICE_PREFIX") or None


def require_reachable_page() -> None:
    """Raise an error if the user's browser cannot reach a page on a port of this machine.

    Raises:
        CourseError: This is a hub without jupyter-server-proxy.
    """
    if hub_prefix() and find_spec("jupyter_server_proxy") is None:
        raise CourseError(
            "a separate page cannot be reached on this JupyterHub, which has no "
            "jupyter-server-proxy. Show the viewer in a notebook: viewer, or viewer.beside()."
        )


def address(port: int, path: str) -> str:
    """Return the address of a page on a port of this machine, for the user's browser.

    `path` has no first slash. If the hub's name is unknown, the address begins with the server's
    path.
    """
    prefix = hub_prefix()
    if prefix is None:
        return f"http://127.0.0.1:{port}/{path}"
    return f"{os.environ.get('JUPYTERHUB_PUBLIC_URL') or prefix}proxy/{port}/{path}"


def announce(subject: str, url: str, *, browser: bool) -> None:
    """Print "what is at url", or show a link in a hub's notebook, and open a browser.

    On a hub no browser is opened, because the user's browser runs on another machine.
    """
    if hub_prefix() is None:
        sys.stdout.write(f"{subject} is at {url}\n")
        if browser:
            webbrowser.open(url)
    elif in_notebook():
        # Imported here because IPython is slow to import and not needed outside of notebooks.
        from IPython.display import display

        link = f'{escape(subject)} is <a href="{escape(url)}" target="_blank">in a tab of its own</a>.'
        display({"text/html": link, "text/plain": f"{subject} is at {url}"}, raw=True)
    else:
        after = " after the name of your hub" if url.startswith("/") else ""
        sys.stdout.write(f"{subject} is at {url}{after}\n")
