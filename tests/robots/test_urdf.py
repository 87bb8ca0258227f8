import pytest

from course_lib.errors import CourseError
from course_lib.robots.urdf import Mimic, parse_urdf
from tests.robots.urdfs import ALL_KINDS, LIMIT, joint, links, robot


def test_joints_are_in_file_order_with_their_limits() -> None:
    tree = parse_urdf(ALL_KINDS)
    assert (tree.name, tree.root) == ("small", "base")
    assert list(tree.joints) == ["drive", "lift", "finger", "thumb", "slide", "fly", "hang"]
    assert tree.joints["lift"].limits == {"lower": -1.0, "upper": 1.0}
    assert tree.joints["drive"].limits == {}
    assert (tree.joints["lift"].unit, tree.joints["drive"].unit) == ("m", "rad")


def test_soft_limits_are_read() -> None:
    soft = '<safety_controller k_velocity="1" soft_lower_limit="-0.5" soft_upper_limit="0.25"/>'
    tree = parse_urdf(robot(links("a", "b"), joint("j", "a", "b", inner=LIMIT + soft)))
    assert tree.joints["j"].limits == {
        "lower": -1.0, "upper": 1.0, "soft_lower_limit": -0.5, "soft_upper_limit": 0.25,
    }  # fmt: skip


def test_mimic_joint_follows_through_a_chain() -> None:
    tree = parse_urdf(ALL_KINDS)
    assert tree.resolve_mimic(tree.joints["finger"]) == Mimic("lift", 2.0, 0.5)
    assert tree.resolve_mimic(tree.joints["thumb"]) == Mimic("lift", -2.0, -0.5)
    assert tree.resolve_mimic(tree.joints["lift"]) == Mimic("lift", 1.0, 0.0)


def test_mimic_of_a_missing_joint_is_independent() -> None:
    tree = parse_urdf(robot(links("a", "b"), joint("j", "a", "b", inner=LIMIT + '<mimic joint="ghost"/>')))
    assert tree.resolve_mimic(tree.joints["j"]) == Mimic("j", 1.0, 0.0)


def test_circular_mimic_joints_are_reported() -> None:
    ring = [LIMIT + f'<mimic joint="{other}"/>' for other in ("k", "j")]
    text = robot(
        links("a", "b", "c"), joint("j", "a", "b", inner=ring[0]), joint("k", "b", "c", inner=ring[1])
    )
    tree = parse_urdf(text)
    with pytest.raises(CourseError, match=r"infinite recursive mimic chain: \['j', 'k', 'j'\]"):
        tree.resolve_mimic(tree.joints["j"])


ORIGIN = '<origin xyz="0 0"/>'


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("<robot", "not XML: unclosed token: line 1, column 0"),
        ("ur10", "not XML: syntax error"),
        ("<launch/>", "Could not find the 'robot' element"),
        (robot(), "No link elements found"),
        (robot(links("a", "a")), "link 'a' is not unique"),
        (robot(links("a", "b"), joint("j", "a", "z")), r"child link \[z\] of joint \[j\] not found"),
        (robot(links("a", "b"), joint("j", "a", "b", "rotary")), r"Joint \[j\] has no known type \[rotary\]"),
        (robot(links("a", "b"), joint("j", "a", "b", inner="")), "does not specify limits"),
        (robot(links("a", "b"), joint("j", "a", "b", inner=LIMIT + ORIGIN)), "2 elements but 3 expected"),
        (robot(links("a", "b", "c"), joint("j", "a", "b")), r"Two root links found: \[a\] and \[c\]"),
        (robot(links("a", "b"), joint("j", "a", "b"), joint("k", "b", "a")), "No root link found"),
        (
            robot(links("a", "b", "c"), joint("j", "a", "b"), joint("k", "a", "c"), joint("l", "b", "c")),
            "not a tree: each link but one must be the child of exactly one joint",
        ),
        (robot(links("a", "b", "c"), joint("k", "b", "c"), joint("l", "c", "b")), "is not a tree"),
    ],
)
def test_invalid_urdf_is_rejected_with_the_reason_of_urdfdom(
    text: str, reason: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(CourseError, match=reason):
        parse_urdf(text)
    assert capfd.readouterr().err == ""
