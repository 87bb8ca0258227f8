"""`%rqt service_caller` and `%rqt reconfigure`: views that call the services of nodes."""

from html import escape
from math import ceil, isfinite, log10
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.graph.graph import Sample
from course_lib.ros.messages import message_class, service_class
from course_lib.ros.messages.conversions import PrintOptions, to_yaml
from course_lib.tools.param import find_node, parameter_client, parameter_nodes
from course_lib.tools.rqt.view import RqtView, table
from course_lib.tools.sources import own_node, wait_for_response
from course_lib.tools.verb import fill

# Time limit for a response in robot time [s]. The page is blocked until then.
ANSWER_LIMIT = 2.0


class ServiceCallerView(RqtView):
    """A service with its request as YAML, and its response or an error."""

    name, title = "service_caller", "Service Caller"

    def build(self) -> None:
        """Create the controls. The first argument selects a service."""
        from ipywidgets import Textarea

        service, names = self.target(), sorted(self._services())
        if service and service not in names:
            raise CourseError(f"There is no service {service}{did_you_mean(service, names) or '.'}")
        self._message = ""
        self.add_choice("Service", names, service, self._choose)
        self.request = Textarea(description="Request", layout={"width": "98%", "height": "130px"})
        self.request.style.description_width = "initial"
        self._choose()

    def buttons(self) -> list[Any]:
        """Add the button Call."""
        return [self.button("Call", "play", self._call), *super().buttons()]

    def body(self) -> list[Any]:
        """Return the request and the response."""
        return [self.request, self.screen]

    def refresh(self) -> None:
        """Update the list of services. The request is unchanged."""
        self.offer("Service", sorted(self._services()))
        self.screen.value = self._message

    def picture(self) -> str:
        """Return the services as a table."""
        return table(("Service", "Type"), sorted(self._services().items()), "Services")

    def _services(self) -> dict[str, str]:
        """Return the services of nodes with their types."""
        return {e.service[0]: e.service[1] for e in self.graph.endpoints() if e.is_service and e.service}

    def _choose(self) -> None:
        """Fill the request with its default values."""
        if type_name := self._services().get(self["Service"]):
            request = message_class(f"{type_name}_Request")()
            self.request.value = to_yaml(request, PrintOptions(truncate=None))
            self._message = f"<p class='rqt-dim'>{type_name}: not called yet.</p>"
        self.refresh()

    def _call(self) -> None:
        self.show_notice("")
        self._message = self.screen.value = "<p class='rqt-dim'>No response.</p>"
        name = self["Service"]
        if name not in self._services():
            raise CourseError("Choose a service first.")
        self.check_time()
        kind: Any = service_class(self._services()[name])
        request = kind.Request()
        fill(request, self.request.value)
        with own_node(self.source) as node:
            response = wait_for_response(
                self.source, node.create_client(kind, name).call_async(request), name, ANSWER_LIMIT
            )
        self._message = f"<b>Response</b><pre>{escape(to_yaml(response, PrintOptions()))}</pre>"


_EVENTS = "/parameter_events", "rcl_interfaces/msg/ParameterEvent"
_EDITOR_LAYOUT = {"width": "420px", "max_width": "100%", "flex": "none"}
_EDITOR_STYLE = {"description_width": "180px"}


class ReconfigureView(RqtView):
    """A row per parameter of a node.

    Its type and range determine the control: slider, check box or field.
    """

    name, title = "reconfigure", "Dynamic Reconfigure"
    topics = _EVENTS[:1]

    def build(self) -> None:
        """Create the controls. The first argument selects a node."""
        from ipywidgets import VBox

        self._values: dict[str, Any] = {}
        self.rows: dict[str, Any] = {}
        # Whether controls are updated with values from the node. Such changes are not sent back to
        # it.
        self._is_reading = False
        self.table = VBox()
        node_name, nodes = self.target(), parameter_nodes(self.source)
        selected = find_node(self.source, node_name) if node_name else nodes[0] if len(nodes) == 1 else None
        self.add_choice("Node", nodes, selected, self._read)
        self.add_text("Filter", hint="part of a name")

    def buttons(self) -> list[Any]:
        """Add a button that reads all values."""
        return [self.button("Refresh", "refresh", self._read)]

    def body(self) -> list[Any]:
        """Return the table, and fill it as soon as the page is displayed."""
        self.run_soon(self._read)
        return [self.table]

    def on_sample(self, sample: Sample) -> None:
        """Display values that other clients have set."""
        if (sample.topic, sample.type_name) == _EVENTS and self.rows:
            from rclpy.parameter import parameter_value_to_python

            event: Any = sample.message()
            if event.node == self["Node"]:
                changes = (*event.new_parameters, *event.changed_parameters)
                self._show({change.name: parameter_value_to_python(change.value) for change in changes})

    def refresh(self) -> None:
        """Update the list of nodes, and show the rows that match the filter."""
        self.offer("Node", parameter_nodes(self.source))
        self.table.children = tuple(row for name, row in self.rows.items() if self["Filter"] in name)

    def picture(self) -> str:
        """Return the parameters of the node, or of all nodes, as a table."""
        rows = []
        for node in [self["Node"]] if self["Node"] else parameter_nodes(self.source):
            for name, value, about in self._parameters(node):
                rows.append([escape(cell) for cell in (node, name, _field_text(value), _note(about))])
        return table(("Node", "Parameter", "Value", "Description"), rows, "Parameters")

    def _parameters(self, node: str) -> list[tuple[str, Any, Any]]:
        """Return name, value and descriptor of each parameter of a node."""
        from rclpy.parameter import parameter_value_to_python

        self.check_time()
        with parameter_client(self.source, node) as ask:
            names = sorted(ask("list_parameters").result.names)
            values, about = ask("get_parameters", names).values, ask("describe_parameters", names).descriptors
        return list(zip(names, map(parameter_value_to_python, values), about, strict=True))

    def _read(self) -> None:
        """Create the rows of the chosen node."""
        node = self["Node"]
        self.show_notice("" if node else "Choose a node.")
        parameters = self._parameters(node) if node else []
        self._values = {name: value for name, value, _ in parameters}
        self.rows = {name: self._row(name, value, about) for name, value, about in parameters}
        self.refresh()

    def _row(self, name: str, value: Any, about: Any) -> Any:
        from ipywidgets import HTML, HBox

        control = _editor(name, value, about)
        control.tooltip, control.disabled = about.description or name, about.read_only or value is None

        def act(change: dict[str, Any]) -> None:
            if not self._is_reading:
                self.run_soon(lambda: self._set(name, change["new"]))

        control.observe(act, "value")
        return HBox([control, HTML(f"<span class='rqt-dim'>{escape(_note(about))}</span>"), HTML()])

    def _set(self, name: str, new: Any) -> None:
        """Set a parameter.

        If the node rejects the value, restore the old one and show the reason.
        """
        from rclpy.parameter import Parameter

        from course_lib.ros.programs.parameter_yaml import read_value

        was = self._values[name]
        self.check_time()
        try:
            value = read_value(new) if isinstance(new, str) and not isinstance(was, str) else new
            with parameter_client(self.source, self["Node"]) as ask:
                (result,) = ask("set_parameters", [Parameter(name, value=value)]).results
            rejection = "" if result.successful else result.reason or "the node rejects it"
        except ValueError as error:
            rejection = f"{new!r} is not a parameter value: {error}"
        if rejection:
            self._show({name: was})
        outcome = f"<span class='rqt-notice'>Not set: {escape(rejection)}</span>" if rejection else "set"
        self.rows[name].children[2].value = outcome

    def _show(self, values: dict[str, Any]) -> None:
        """Display values received from the node."""
        self._is_reading = True
        for name in values.keys() & self.rows.keys():
            control = self.rows[name].children[0]
            self._values[name] = values[name]
            control.value = _field_text(values[name]) if isinstance(control.value, str) else values[name]
        self._is_reading = False


def _note(about: Any) -> str:
    """Return a descriptor's range, description and constraints as one line."""
    ranges = (*about.integer_range, *about.floating_point_range)
    limits = [f"{limits.from_value:g} … {limits.to_value:g}" for limits in ranges]
    texts = (*limits, "read-only" if about.read_only else "", about.description, about.additional_constraints)
    return " · ".join(filter(None, texts))


def _editor(name: str, value: Any, about: Any) -> Any:
    """Return the control for a value's type and its descriptor's range."""
    import ipywidgets as widgets

    settings: dict[str, Any] = {"description": name, "style": _EDITOR_STYLE, "layout": _EDITOR_LAYOUT}
    if isinstance(value, bool):
        return widgets.Checkbox(value, **settings)
    if not isinstance(value, int | float):
        return widgets.Text(_field_text(value), continuous_update=False, **settings)
    is_int = isinstance(value, int)
    for limits in about.integer_range if is_int else about.floating_point_range:
        low, high = limits.from_value, limits.to_value
        if not isfinite(high - low):
            continue
        # Imported here because anywidget is slow to import.
        from course_lib.controls import IntSlider, Slider

        # A slider sets the value when it is released. A step of 0 is replaced by a default.
        width = _EDITOR_STYLE["description_width"]
        settings |= {"value": value, "min": low, "max": high, "description_width": width}
        settings.pop("style")
        if is_int:
            return IntSlider(**settings, step=limits.step or 1, is_live=False)
        step = limits.step or (high - low) / 1000
        return Slider(**settings, step=step, decimals=max(0, ceil(1 - log10(step or 1))), is_live=False)
    return (widgets.IntText if is_int else widgets.FloatText)(value, **settings)


def _field_text(value: Any) -> str:
    """Return a value as a string for a text field."""
    return "not set" if value is None else str(value)
