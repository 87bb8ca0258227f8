"""Which pixels a scenario's evidence keeps: those of the first pictures of each topic."""

from collections import Counter
from dataclasses import replace
from typing import Any

from course_lib.ros.graph import Sample
from course_lib.ros.graph_server import PICTURES
from course_lib.ros.messages import serialize

ROOM = 4 << 20  # bytes for each topic
ALL = 8 << 20  # bytes for all topics


class ImageRoom:
    """Counts what each topic's pictures take."""

    def __init__(self) -> None:
        self._taken = Counter[str]()
        self._kept = 0

    def fitted(self, sample: Sample) -> Sample:
        """The sample, without its pixels where there is no more room for them."""
        if sample.type_name not in PICTURES:
            return sample
        self._taken[sample.topic] += len(sample.cdr)
        if self._taken[sample.topic] > ROOM or self._kept + len(sample.cdr) > ALL:
            return _without_pixels(sample)
        self._kept += len(sample.cdr)
        return sample


def _without_pixels(sample: Sample) -> Sample:
    try:
        message: Any = sample.message()
    except Exception:  # the bytes come from a student's process: what is no picture has no header to keep
        return replace(sample, cdr=b"")
    message.data = []
    return replace(sample, cdr=serialize(message))
