# mypy: disable-error-code="import-not-found, untyped-decorator"
"""Command lines of nodes, and names of services' parts."""

from tempfile import NamedTemporaryFile

from probing import main, outcome, probe
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


@probe
def parts_of_services() -> list[str]:
    from std_srvs.srv import SetBool, SetBool_Request, SetBool_Response

    return [repr(SetBool.Request is SetBool_Request), repr(SetBool.Response is SetBool_Response)]


if __name__ == "__main__":
    main()
