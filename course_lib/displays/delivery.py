"""Whether a message reaches a display; RViz is silent if not, so we say why."""

from collections.abc import Mapping

from course_lib.displays.display import Display, Interest
from course_lib.displays.statuses import StatusRow
from course_lib.ros.graph import Sample
from course_lib.ros.qos import incompatible


def reaches(sample: Sample, interest: Interest, match_qos: bool) -> bool:
    """Say whether a sample reaches an interest to its topic, and leave a hint if not."""
    topic, policy, problem = sample.topic, None, None
    if sample.type_name != interest.type_name:
        problem = f"{topic} carries {sample.type_name}; this display takes {interest.type_name}."
    elif match_qos and (policy := incompatible(sample.qos, interest.qos)):
        problem = (
            f"{topic} is published with another {policy} than this display asks for, so nothing arrives. "
            "Change the display's policy below Topic, or the publisher's QoS."
        )
    interest.statuses.hint(f"Topic {topic}", *([problem] if problem else []))
    return problem is None


def hint_at_held(interest: Interest) -> None:
    """Say, until more comes, that a publisher holds something that a display does not ask for."""
    topic = interest.topic
    text = (
        f"{topic} was published before this display was here, and its publisher holds it for latecomers; "
        "ask for it with Durability Policy: Transient Local."
    )
    interest.statuses.hint(f"Topic {topic}", text)


def silence(display: Display, types: Mapping[str, str]) -> list[StatusRow]:
    """Say which of the topics that were heard, by name and type, a silent display could listen to."""
    topics = {interest.topic for interest in display.interests}
    wanted = {interest.type_name for interest in display.interests}
    others = sorted(topic for topic, name in types.items() if name in wanted)
    if not topics or topics & types.keys() or not others:
        return []
    text = f"nothing has come on {min(topics)}; messages of its type come on {', '.join(others)}."
    return [StatusRow(display.name, "Topic", "hint", text)]
