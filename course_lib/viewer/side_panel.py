"""JupyterLab's panel beside the notebook, which holds a view until somebody closes it."""

from typing import Any

from ipywidgets import Widget


class SidePanel:
    """The panel of one widget, opened and closed as its pages ask: only they know what JupyterLab is.

    Args:
        widget: What the panel shows.
        title: Of the panel's tab.
    """

    def __init__(self, widget: Widget, title: str) -> None:
        self._widget, self._title = widget, title
        self._panel: Widget | None = None

    def take(self, order: dict[str, Any]) -> str:
        """Open or close the panel; with `again` false, one that was opened before will do.

        Returns:
            The panel's model, or "".
        """
        wanted = bool(order.get("open"))
        if not wanted or order.get("again", True):
            self.close()
        if wanted and self._panel is None:
            from sidecar import Sidecar  # here: most kernels never need it

            view = {"version_major": 2, "version_minor": 0, "model_id": self._widget.model_id}
            data = {"application/vnd.jupyter.widget-view+json": view}
            shown = {"output_type": "display_data", "data": data, "metadata": {}}
            self._panel = Sidecar(title=self._title, anchor="split-right", outputs=(shown,))
        return "" if self._panel is None else str(self._panel.model_id)

    def close(self) -> None:
        """Remove the panel from the page."""
        if self._panel is not None:
            self._panel.close()
            self._panel = None
