"""`%rqt reconfigure`: the parameters of nodes, to be changed while they run."""

from html import escape
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.graph import Sample
from course_lib.ros.messages import deserialize, message_class
from course_lib.tools.rqt.markup import table
from course_lib.tools.rqt.service_caller import ask, services
from course_lib.tools.rqt.view import View, near

_LIST = "/list_parameters"
_WIDTH = {"width": "420px", "flex": "none"}
_STYLE = {"description_width": "180px"}


class ReconfigureView(View):
    """A row per parameter of a node: a slider, a check box or a field, by its type and its range."""

    name, title = "reconfigure", "Dynamic Reconfigure"

    def build(self) -> None:
        """Make the controls; a word is the node to begin with."""
        from ipywidgets import VBox

        wanted, nodes = self.wanted(), self._nodes()
        if wanted not in (None, *nodes):
            raise CourseError(f"Node not found: {wanted}. {near(str(wanted), nodes)}")
        self._values: dict[str, Any] = {}
        self._rows: dict[str, Any] = {}
        self._reading = False  # whether values come from the node, not from the page
        self._table = VBox()
        self.add_choice("Node", nodes, wanted or (nodes[0] if len(nodes) == 1 else None), self._read)
        self.add_text("Filter", hint="part of a name")

    def buttons(self) -> list[Any]:
        """Read all values again on request."""
        return [self.button("Refresh", "refresh", self._read)]

    def body(self) -> list[Any]:
        """Show the rows, once read."""
        self.soon(self._read)
        return [self._table]

    def hear(self, sample: Sample) -> None:
        """Follow what others set."""
        if sample.topic == "/parameter_events" and self._rows:
            event: Any = deserialize(sample.cdr, message_class(sample.type_name))
            if event.node == self["Node"]:
                self._show(
                    {p.name: value_of(p.value) for p in (*event.new_parameters, *event.changed_parameters)}
                )

    def refresh(self) -> None:
        """Bring the list of nodes up to date, and the rows that pass the filter."""
        self.offer("Node", self._nodes())
        self._table.children = tuple(row for name, row in self._rows.items() if self["Filter"] in name)

    def picture(self) -> str:
        """Write the parameters of the node, or of all, as a table."""
        rows = []
        for node in [self["Node"]] if self["Node"] else self._nodes():
            for name, value, about in self._parameters(node):
                rows.append([escape(str(cell)) for cell in (node, name, shown(value), _note(about))])
        return table(("Node", "Parameter", "Value", "Description"), rows, "Parameters")

    def _nodes(self) -> list[str]:
        return sorted(name.removesuffix(_LIST) for name in services(self.graph) if name.endswith(_LIST))

    def _parameters(self, node: str) -> list[tuple[str, Any, Any]]:
        """Ask a node for its parameters: names, values and descriptors."""
        from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters

        names = sorted(ask(self.graph, f"{node}{_LIST}", ListParameters.Request()).result.names)
        values = ask(self.graph, f"{node}/get_parameters", GetParameters.Request(names=names)).values
        request = DescribeParameters.Request(names=names)
        about = ask(self.graph, f"{node}/describe_parameters", request).descriptors
        return list(zip(names, map(value_of, values), about, strict=True))

    def _read(self) -> None:
        """Make the rows of the node that is chosen."""
        node = self["Node"]
        self.say("" if node else "Choose a node.")
        found = self._parameters(node) if node else []
        self._values = {name: value for name, value, _ in found}
        self._rows = {name: self._row(name, value, about) for name, value, about in found}
        self.refresh()

    def _row(self, name: str, value: Any, about: Any) -> Any:
        from ipywidgets import HTML, HBox

        control, said = editor(name, value, about), HTML()
        control.tooltip, control.disabled = about.description or name, control.disabled or about.read_only
        note = HTML(f"<span class='rqt-dim'>{escape(_note(about))}</span>")

        def act(change: dict[str, Any]) -> None:
            if not self._reading:
                self.soon(lambda: self._set(name, change["new"]))

        control.observe(act, "value")
        return HBox([control, note, said])

    def _set(self, name: str, text: Any) -> None:
        """Set a parameter; what the node refuses is taken back, with its reason."""
        from rcl_interfaces.srv import SetParameters
        from rclpy.impl.parameter_yaml import read_value
        from rclpy.parameter import Parameter

        was, said = self._values[name], self._rows[name].children[2]
        try:
            value = read_value(text) if isinstance(text, str) and not isinstance(was, str) else text
            request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
            (result,) = ask(self.graph, f"{self['Node']}/set_parameters", request).results
            refusal = "" if result.successful else result.reason or "the node refuses it"
        except ValueError as error:
            refusal = f"{text!r} is no value of a parameter: {error}"
        if refusal:
            self._show({name: was})
        said.value = f"<span class='rqt-notice'>Not set: {escape(refusal)}</span>" if refusal else "set"

    def _show(self, values: dict[str, Any]) -> None:
        """Show values that a node has."""
        self._reading = True
        for name in values.keys() & self._rows.keys():
            control = self._rows[name].children[0]
            self._values[name] = values[name]
            control.value = shown(values[name]) if isinstance(control.value, str) else values[name]
        self._reading = False


def _note(about: Any) -> str:
    """Say what a descriptor says, in a line."""
    limits = [
        f"{r.from_value:g} … {r.to_value:g}" for r in (*about.integer_range, *about.floating_point_range)
    ]
    texts = (*limits, "read-only" if about.read_only else "", about.description, about.additional_constraints)
    return " · ".join(filter(None, texts))


def editor(name: str, value: Any, about: Any) -> Any:
    """Make the control that suits a value and its descriptor."""
    import ipywidgets as widgets

    settings: dict[str, Any] = {"description": name, "style": _STYLE, "layout": _WIDTH}
    if isinstance(value, bool):
        return widgets.Checkbox(value, **settings)
    if not isinstance(value, int | float):
        return widgets.Text(shown(value), continuous_update=False, disabled=value is None, **settings)
    is_int = isinstance(value, int)
    for limits in about.integer_range if is_int else about.floating_point_range:
        low, high = limits.from_value, limits.to_value
        settings |= {"min": low, "max": high, "step": limits.step or (1 if is_int else (high - low) / 1000)}
        slider = widgets.IntSlider if is_int else widgets.FloatSlider
        return slider(value, continuous_update=False, **settings)
    return (widgets.IntText if is_int else widgets.FloatText)(value, **settings)


def shown(value: Any) -> str:
    """Write a value as a text field has it: strings as they are, lists as YAML."""
    if value is None:
        return "not set"
    return str(value if isinstance(value, str | bool | int | float) else list(value))


def value_of(message: Any) -> Any:
    """Give what a ParameterValue holds; None if it is not set."""
    from rcl_interfaces.msg import Parameter as ParameterMessage
    from rclpy.parameter import Parameter

    return Parameter.from_parameter_msg(ParameterMessage(value=message)).value
