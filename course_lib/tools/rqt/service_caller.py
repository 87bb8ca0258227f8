"""`%rqt service_caller`: ask a service, and see what it answers."""

from html import escape
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages import message_class, service_class
from course_lib.tools.asking import answer, own_node
from course_lib.tools.message_fields import fill
from course_lib.tools.message_text import Style, to_yaml
from course_lib.tools.rqt.markup import table
from course_lib.tools.rqt.view import View

PATIENCE = 2.0  # [s] of robot time for an answer: the page waits meanwhile


class ServiceCallerView(View):
    """A service, its request as YAML, its response or what went wrong."""

    name, title = "service_caller", "Service Caller"

    def build(self) -> None:
        """Make the controls; a word is the service to begin with."""
        from ipywidgets import Textarea

        wanted, names = self.wanted(), sorted(self._services())
        if wanted and wanted not in names:
            raise CourseError(f"There is no service {wanted}{did_you_mean(wanted, names) or '.'}")
        self._told = ""
        self.add_choice("Service", names, wanted, self._choose)
        self._request = Textarea(description="Request", layout={"width": "98%", "height": "130px"})
        self._request.style.description_width = "initial"
        self._choose()

    def buttons(self) -> list[Any]:
        """Add Call."""
        return [self.button("Call", "play", self._call), *super().buttons()]

    def body(self) -> list[Any]:
        """Show the request above the response."""
        return [self._request, self.screen]

    def refresh(self) -> None:
        """List the services that there are now; what is being written stays."""
        self.offer("Service", sorted(self._services()))
        self.screen.value = self._told

    def picture(self) -> str:
        """Write what services there are."""
        return table(("Service", "Type"), sorted(self._services().items()), "Services")

    def _services(self) -> dict[str, str]:
        """Give the services that nodes offer, with their types."""
        return {e.service[0]: e.service[1] for e in self.graph.endpoints() if e.is_service and e.service}

    def _choose(self) -> None:
        """Begin a request with the default values."""
        if type_name := self._services().get(self["Service"]):
            request = message_class(f"{type_name}_Request")()
            self._request.value = to_yaml(request, Style(truncate=None))
            self._told = f"<p class='rqt-dim'>{type_name}: not called yet.</p>"
        self.refresh()

    def _call(self) -> None:
        self.say("")
        self._told = self.screen.value = "<p class='rqt-dim'>No response.</p>"
        name = self["Service"]
        if name not in self._services():
            raise CourseError("Choose a service first.")
        self.check_time()
        kind: Any = service_class(self._services()[name])
        request = kind.Request()
        fill(request, self._request.value)
        with own_node(self.source) as node:
            response = answer(self.source, node.create_client(kind, name).call_async(request), name, PATIENCE)
        self._told = f"<b>Response</b><pre>{escape(to_yaml(response, Style()))}</pre>"
