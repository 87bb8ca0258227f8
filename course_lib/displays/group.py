"""Groups of displays, as in RViz's tree."""

from collections.abc import Iterator, Mapping
from typing import Any, Union

from course_lib.displays.display import Display

GROUP = "rviz_common/Group"


class Group:
    """A node of RViz's tree that holds displays and further groups; the root is one without a name."""

    def __init__(self, name: str = "", config: Mapping[str, Any] | None = None, ticked: bool = True) -> None:
        self.name = name
        self.config = dict(config or {})  # of the layout it comes from
        self.ticked = ticked
        self.members: list[Display | Group] = []

    def tick(self, above: bool = True) -> None:
        """Tell all displays below whether every group above them is ticked."""
        for member in self.members:
            if isinstance(member, Group):
                member.tick(above and self.ticked)
            else:
                member.show_in_group(above and self.ticked)

    def displays(self) -> Iterator[Display]:
        """Iterate over the displays in it, at any depth, in the order of the tree."""
        for member in self.members:
            yield from member.displays() if isinstance(member, Group) else (member,)

    def groups(self) -> Iterator["Group"]:
        """Iterate over this group and all groups in it."""
        yield self
        for member in self.members:
            if isinstance(member, Group):
                yield from member.groups()

    def holder(self, wanted: Union[Display, "Group"]) -> "Group":
        """Return the group that holds a member of the tree directly."""
        return next(group for group in self.groups() if any(m is wanted for m in group.members))
