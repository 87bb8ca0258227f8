"""`%rqt service_caller`: ask a service, and see what it answers."""

from html import escape
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.driving import running_nodes, wait_for
from course_lib.ros.graph import Graph
from course_lib.ros.messages import message_class, service_class
from course_lib.tools.message_fields import fill
from course_lib.tools.message_text import Style, to_yaml
from course_lib.tools.rqt.markup import table
from course_lib.tools.rqt.view import View, near
from course_lib.tools.sources import NODE_NAME

PATIENCE = 2.0  # [s] of robot time for an answer


class ServiceCallerView(View):
    """A service, its request as YAML, its response or what went wrong."""

    name, title = "service_caller", "Service Caller"

    def build(self) -> None:
        """Make the controls; a word is the service to begin with."""
        from ipywidgets import Textarea

        wanted, names = self.wanted(), sorted(services(self.graph))
        if wanted not in (None, *names):
            raise CourseError(f"There is no service {wanted}. {near(str(wanted), names)}")
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
        self.offer("Service", sorted(services(self.graph)))
        self.screen.value = self._told

    def picture(self) -> str:
        """Write what services there are."""
        return table(("Service", "Type"), sorted(services(self.graph).items()), "Services")

    def _choose(self) -> None:
        """Begin a request with the default values."""
        if self["Service"]:
            request = message_class(f"{services(self.graph)[self['Service']]}_Request")()
            self._request.value = to_yaml(request, Style(truncate=None)) if request._KINDS else "{}"
            self._told = f"<p class='rqt-dim'>{services(self.graph)[self['Service']]}: not called yet.</p>"
        self.refresh()

    def _call(self) -> None:
        if self["Service"] is None:
            raise CourseError("Choose a service first.")
        self.say("")
        self._told = self.screen.value = "<p class='rqt-dim'>No response.</p>"
        request = message_class(f"{services(self.graph)[self['Service']]}_Request")()
        fill(request, self._request.value)
        answer = ask(self.graph, self["Service"], request)
        self._told = f"<b>Response</b><pre>{escape(to_yaml(answer, Style()))}</pre>"


def services(graph: Graph) -> dict[str, str]:
    """Give the services that nodes offer, with their types."""
    return {e.service[0]: e.service[1] for e in graph.endpoints() if e.is_service and e.service}


def ask(graph: Graph, service: str, request: Any) -> Any:
    """Ask a service with a node of our own, which drives those that run live; returns the response.

    Raises:
        CourseError: Nobody answers.
    """
    from rclpy.node import Node

    node = Node(NODE_NAME, start_parameter_services=False, enable_rosout=False)
    running_nodes().append(node)
    try:
        client = node.create_client(service_class(services(graph)[service]), service)
        future = client.call_async(request)
        if not wait_for(future.done, seconds=PATIENCE):
            raise CourseError(
                f"{service} does not answer: is its node running? Start it, like run_live(node)."
            )
        return future.result()
    finally:
        running_nodes().remove(node)
        node.destroy_node()
