import pytest
from rclpy.exceptions import InvalidNamespaceException, InvalidNodeNameException, InvalidTopicNameException
from rclpy.impl.names import expand_name, validate_namespace, validate_node_name, validate_topic_name


@pytest.mark.parametrize(
    ("name", "error", "index"),
    [
        ("", "node name must not be empty", 0),
        ("my node", "node name must not contain characters other than alphanumerics or '_'", 2),
        ("robot/arm", "node name must not contain characters other than alphanumerics or '_'", 5),
        ("2nd", "node name must not start with a number", 0),
        ("x" * 256, "node name length should not exceed '255'", 254),
    ],
)
def test_invalid_node_name_is_rejected_with_a_caret_below_the_character(
    name: str, error: str, index: int
) -> None:
    with pytest.raises(InvalidNodeNameException) as caught:
        validate_node_name(name)
    assert str(caught.value) == f"Invalid node name: {error}:\n  '{name}'\n   {' ' * index}^"


@pytest.mark.parametrize(
    ("name", "error", "index"),
    [
        ("", "topic name must not be empty string", 0),
        ("x/", "topic name must not end with a forward slash", 1),
        ("/", "topic name must not end with a forward slash", 0),
        ("4d", "topic name token must not start with a number", 0),
        ("/scan/4d", "topic name token must not start with a number", 6),
        (
            "/laser scan",
            "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'",
            6,
        ),
        ("a~", "topic name must not have tilde '~' unless it is the first character", 1),
        ("x{node", "topic name must not have unmatched (unbalanced) curly braces '{}'", 1),
        ("x}", "topic name must not have unmatched (unbalanced) curly braces '{}'", 1),
        ("{a/b}", "substitution name must not contain characters other than alphanumerics or '_'", 2),
        ("{4x}", "substitution name must not start with a number", 1),
    ],
)
def test_invalid_topic_name_is_rejected_with_a_caret_below_the_character(
    name: str, error: str, index: int
) -> None:
    with pytest.raises(InvalidTopicNameException) as caught:
        validate_topic_name(name)
    assert str(caught.value) == f"Invalid topic name: {error}:\n  '{name}'\n   {' ' * index}^"


@pytest.mark.parametrize(
    ("namespace", "error", "index"),
    [
        ("a", "namespace must be absolute, it must lead with a '/'", 0),
        ("/a/", "namespace must not end with a '/', unless only a '/'", 2),
        ("/a-b", "namespace must not contain characters other than alphanumerics, '_', or '/'", 2),
        ("/a//b", "namespace must not contain repeated '/'", 3),
        ("/a/1", "namespace must not have a token that starts with a number", 3),
    ],
)
def test_invalid_namespace_is_rejected_with_a_caret_below_the_character(
    namespace: str, error: str, index: int
) -> None:
    with pytest.raises(InvalidNamespaceException) as caught:
        validate_namespace(namespace)
    assert str(caught.value) == f"Invalid namespace: {error}:\n  '{namespace}'\n   {' ' * index}^"


@pytest.mark.parametrize(
    ("topic", "namespace", "full"),
    [
        ("scan", "/", "/scan"),
        ("scan", "/robot", "/robot/scan"),
        ("/scan", "/robot", "/scan"),
        ("~/scan", "/robot", "/robot/talker/scan"),
        ("~", "/", "/talker"),
        ("{node}/scan", "/robot", "/robot/talker/scan"),
        ("{ns}/scan", "/robot", "/robot/scan"),
    ],
)
def test_topic_name_is_expanded_with_namespace_and_node_name(topic: str, namespace: str, full: str) -> None:
    assert expand_name(topic, "talker", namespace) == full


def test_expanded_name_is_validated() -> None:
    with pytest.raises(InvalidTopicNameException, match=r"topic name must not contain repeated '/'"):
        expand_name("a//b", "talker", "/")


def test_unknown_substitution_in_a_topic_name_is_rejected() -> None:
    with pytest.raises(ValueError, match=r"topic name '\{x\}' is invalid: unknown substitution: \{x\}"):
        expand_name("{x}", "talker", "/")
