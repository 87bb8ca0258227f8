"""What `ros2 topic`, `service` and `action` do alike: list names, from a name to its types, and back."""

from argparse import Namespace
from collections.abc import Callable, Mapping

from course_lib.tools.sources import Source
from course_lib.tools.verb import NODE_OPTIONS, Option, Verb, Write, flag, value

Types = Mapping[str, list[str]]  # by name
There = Callable[[Source, bool], Types]  # what there is: where, and whether with what is hidden


def show_types(kind: str) -> Option:
    """Give the option that adds types to names."""
    return flag("-t", "--show-types", help=f"Additionally show the {kind} type")


def count(kind: str) -> Option:
    """Give the option that says no names, only how many there are."""
    help_text = f"Only display the number of {kind}s discovered"
    return flag("-c", f"--count-{kind}s", dest="count", help=help_text)


def hidden(kind: str) -> Option:
    """Give the option that adds what ROS hides."""
    return flag(f"--include-hidden-{kind}s", dest="hidden", help=f"Consider hidden {kind}s as well")


def write_names(found: Types, arguments: Namespace, write: Write) -> None:
    """Print names, if wanted with their types, or how many there are."""
    if arguments.count:
        write(f"{len(found)}\n")
        return
    for name, types in found.items():
        write(f"{name} [{', '.join(types)}]\n" if arguments.show_types else f"{name}\n")


def type_verb(kind: str, about: str, there: There, name: Option) -> Verb:
    """Make the verb that prints the types of a name; as in ROS nothing if there is no such name."""

    def run(source: Source, arguments: Namespace, write: Write) -> None:
        types = there(source, True).get(getattr(arguments, f"{kind}_name"), ())
        write("".join(f"{one}\n" for one in types))

    return Verb(kind, "type", about, (*NODE_OPTIONS, name), run)


def find_verb(kind: str, there: There, type_help: str) -> Verb:
    """Make the verb that prints the names of a type."""

    def run(source: Source, arguments: Namespace, write: Write) -> None:
        wanted = getattr(arguments, f"{kind}_type")
        found = [name for name, types in there(source, arguments.hidden).items() if wanted in types]
        write(f"{len(found)}\n" if arguments.count else "".join(f"{name}\n" for name in found))

    options = (*NODE_OPTIONS, value(f"{kind}_type", help=type_help), count(kind), hidden(kind))
    return Verb(kind, "find", f"Output a list of available {kind}s of a given type", options, run)
