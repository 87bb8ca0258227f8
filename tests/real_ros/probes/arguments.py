# mypy: disable-error-code="import-not-found, untyped-decorator"
"""Command lines of nodes, and names of services' parts."""

from tempfile import NamedTemporaryFile
from typing import Any

from probing import lines, main, outcome, probe
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter


def _name(*args: str) -> list[str]:
    node = Node("n", cli_args=list(args))
    return [node.get_fully_qualified_name(), node.resolve_topic_name("chatter")]


@probe
def remappings_of_ros_1() -> list[list[str]]:
    return [
        _name("chatter:=other"),
        _name("__ns:=/q", "__node:=y", "word"),
        _name("-r", "__node:=x"),
        _name("x:=1"),
        _name("--ros-args", "-r", "__node:=z"),
    ]


@probe
def empty_list_in_a_file_of_parameters() -> list[str]:
    with NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write("n:\n  ros__parameters:\n    names: []\n    more: [a]\n")
        file.flush()
        node = Node("n", cli_args=["--ros-args", "--params-file", file.name])
    declared = outcome(lambda: node.declare_parameter("names", Parameter.Type.STRING_ARRAY).type_.name)
    more = outcome(lambda: node.declare_parameter("more", Parameter.Type.STRING_ARRAY).value)
    return [declared, outcome(lambda: node.get_parameter("names").value), more]


NAMES = ("n", "/n", "//n", "n/", "/n/", "ns/n", "ns//n", "/**", "**/n", "/ns/n/")
INNER = (("ns", "n"), ("/ns", "n"), ("/ns/", "n"), ("/ns", "/n"), ("ns", "/n"), ("/", "n"), ("/ns", "/**"))


@probe
def slashes_and_tabs_in_a_file_of_parameters() -> dict[str, str]:
    parameters = "ros__parameters:\n    a: 1\n"
    texts = {name: f"{name}:\n  {parameters}" for name in NAMES}
    texts |= {f"{ns} {name}": f"{ns}:\n {name}:\n  {parameters}" for ns, name in INNER}
    texts["tabs"] = "n:\n  ros__parameters:\t\n    a: 1\t# one\n    b:\t2\n"
    return {name: outcome(_values, text).partition(":")[0] for name, text in texts.items()}


NESTED = """
    [[1],[2]] [[1],[2,3]] [[1,2]] [[[1]],[2]] [[1],[a]] [[],[1]] [[1],[]] [[1],2] [1,[2]] [[[1],[2]]]
    [[1.5],[x,2]] [[1],[2,a]] [[1],[[2]],[3]] [[]] [[1],[true,false]] [[1],[2],a] [[a],[1.5]] [a,[1],b]
"""


def _nested(value: str) -> Any:
    node = Node("n", cli_args=["--ros-args", "-p", f"a:={value}"], allow_undeclared_parameters=True)
    return node.declare_parameter("a", descriptor=ParameterDescriptor(dynamic_typing=True)).value


lines("nested", **{value: lambda value=value: _nested(value) for value in NESTED.split()})
lines(
    "malformed",
    dot_at_the_end=lambda: _name("--ros-args", "-p", "a.:=1"),
    two_dots=lambda: _name("--ros-args", "-p", "a..b:=1"),
    end_as_value=lambda: _name("--ros-args", "-p", "--"),
    end_as_file=lambda: _name("--ros-args", "--params-file", "--", "--ros-args"),
    start_as_value=lambda: _name("--ros-args", "-r", "--ros-args"),
)


def _values(text: str) -> list[list[str]]:
    with NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write(text)
        file.flush()
        options: Any = {"automatically_declare_parameters_from_overrides": True}
        words = ["--ros-args", "--params-file", file.name]
        nodes = [Node("n", namespace=ns, cli_args=words, **options) for ns in (None, "ns")]
    return [[name for name in ("a", "b") if node.has_parameter(name)] for node in nodes]


@probe
def parts_of_services() -> list[str]:
    from std_srvs.srv import SetBool, SetBool_Request, SetBool_Response

    return [repr(SetBool.Request is SetBool_Request), repr(SetBool.Response is SetBool_Response)]


if __name__ == "__main__":
    main()
