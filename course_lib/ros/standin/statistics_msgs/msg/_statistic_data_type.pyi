# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message

class StatisticDataType(Message):
    STATISTICS_DATA_TYPE_UNINITIALIZED: Final = 0
    STATISTICS_DATA_TYPE_AVERAGE: Final = 1
    STATISTICS_DATA_TYPE_MINIMUM: Final = 2
    STATISTICS_DATA_TYPE_MAXIMUM: Final = 3
    STATISTICS_DATA_TYPE_STDDEV: Final = 4
    STATISTICS_DATA_TYPE_SAMPLE_COUNT: Final = 5
    def __init__(
        self,
        *,
        check_fields: bool = ...,
    ) -> None: ...
