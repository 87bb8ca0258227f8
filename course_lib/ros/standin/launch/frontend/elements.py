"""The elements and substitutions of launch in XML and YAML files."""

from launch import actions, substitutions
from launch.entities import LaunchContext, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.frontend.grammar import (
    ELEMENTS,
    SUBSTITUTIONS,
    Attribute,
    Element,
    Form,
    command_line,
    launch_arguments,
    list_reader,
    mapping,
    on_exit,
    reader_of,
    text,
    word,
)
from launch.frontend.grammar import actions as inner

_NAME = Attribute("name", text, needed=True)
_VALUE = Attribute("value", text, needed=True)
_INNER = Attribute("", inner, "actions")
# Attributes of all elements that start a process.
PROCESS = (
    Attribute("cwd", text),
    Attribute("name", text),
    Attribute("on_exit", on_exit),
    Attribute("launch-prefix", text, "prefix"),
    Attribute("output", text),
    Attribute("respawn", text),
    Attribute("respawn_max_retries", reader_of(int)),
    Attribute("respawn_delay", reader_of(float)),
    Attribute("sigkill_timeout", reader_of(float)),
    Attribute("sigterm_timeout", reader_of(float)),
    Attribute("shell", reader_of(bool)),
    Attribute("emulate_tty", reader_of(bool)),
    Attribute("env", mapping, "additional_env"),
)
_CHOICE = Element(lambda value: value, (Attribute("value", word, needed=True),), conditional=False)

ELEMENTS |= {
    "append_env": Element(
        actions.AppendEnvironmentVariable,
        (_NAME, _VALUE, Attribute("prepend", reader_of(bool)), Attribute("separator", text)),
    ),
    "arg": Element(
        actions.DeclareLaunchArgument,
        (
            Attribute("name", word, needed=True),
            Attribute("default", text, "default_value"),
            Attribute("description", word),
            Attribute("choice", list_reader(_CHOICE), "choices"),
        ),
    ),
    "executable": Element(actions.ExecuteProcess, (Attribute("cmd", command_line, needed=True), *PROCESS)),
    "group": Element(
        actions.GroupAction,
        (
            Attribute("scoped", reader_of(bool)),
            Attribute("forwarding", reader_of(bool)),
            Attribute("keep", mapping, "launch_configurations"),
            Attribute("keep", inner, "actions"),
        ),
    ),
    "include": Element(
        actions.IncludeLaunchDescription,
        (
            Attribute("file", text, "launch_description_source", needed=True),
            Attribute("let", launch_arguments, "launch_arguments"),
        ),
    ),
    "let": Element(actions.SetLaunchConfiguration, (_NAME, _VALUE)),
    "log": Element(actions.LogInfo, (Attribute("message", text, "msg", needed=True),)),
    "reset": Element(
        actions.ResetLaunchConfigurations, (Attribute("keep", mapping, "launch_configurations"),)
    ),
    "reset_env": Element(actions.ResetEnvironment),
    "set_env": Element(actions.SetEnvironmentVariable, (_NAME, _VALUE)),
    "shutdown": Element(actions.Shutdown, (Attribute("reason", text),)),
    "timer": Element(
        actions.TimerAction,
        (
            Attribute("period", reader_of(float), needed=True),
            _INNER,
            Attribute("cancel_on_shutdown", reader_of(bool)),
        ),
    ),
    "unset_env": Element(actions.UnsetEnvironmentVariable, (_NAME,)),
}


def _expression(value: Some, modules: Some = "math") -> substitutions.PythonExpression:
    """Create `$(eval …)`. The second argument contains module names, separated by commas."""
    names = text_of(LaunchContext(), modules).split(",")
    return substitutions.PythonExpression(value, [name.strip() for name in names if name.strip()])


SUBSTITUTIONS |= {
    "all": Form(substitutions.AllSubstitution, 0, None),
    "and": Form(substitutions.AndSubstitution, 2, 2),
    "anon": Form(substitutions.AnonName, 1, 1),
    "any": Form(substitutions.AnySubstitution, 0, None),
    "command": Form(
        lambda command, on_stderr="fail": substitutions.Command(command, on_stderr=on_stderr), 1, 2
    ),
    "dirname": Form(substitutions.ThisLaunchFileDir),
    "env": Form(
        lambda name, default=None: substitutions.EnvironmentVariable(name, default_value=default), 1, 2
    ),
    "equals": Form(substitutions.EqualsSubstitution, 2, 2),
    "eval": Form(_expression, 1, 2),
    "file-content": Form(substitutions.FileContent, 1, 1),
    "filename": Form(substitutions.ThisLaunchFile),
    "find-exec": Form(lambda name: substitutions.FindExecutable(name=name), 1, 1),
    "if": Form(substitutions.IfElseSubstitution, 2, 3),
    "launch_log_dir": Form(substitutions.LaunchLogDir),
    "log_dir": Form(substitutions.LaunchLogDir),
    "not": Form(substitutions.NotSubstitution, 1, 1),
    "not-equals": Form(substitutions.NotEqualsSubstitution, 2, 2),
    "or": Form(substitutions.OrSubstitution, 2, 2),
    "var": Form(lambda name, default=None: substitutions.LaunchConfiguration(name, default=default), 1, 2),
}
