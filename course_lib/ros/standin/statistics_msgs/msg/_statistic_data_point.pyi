# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class StatisticDataPoint(Message):
    data_type: int
    data: float
    def __init__(
        self,
        *,
        data_type: int = ...,
        data: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
