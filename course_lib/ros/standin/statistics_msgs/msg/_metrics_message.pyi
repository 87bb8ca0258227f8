# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message
from statistics_msgs.msg._statistic_data_point import StatisticDataPoint

class MetricsMessage(Message):
    measurement_source_name: str
    metrics_source: str
    unit: str
    window_start: Time
    window_stop: Time
    statistics: list[StatisticDataPoint]
    def __init__(
        self,
        *,
        measurement_source_name: str = ...,
        metrics_source: str = ...,
        unit: str = ...,
        window_start: Time = ...,
        window_stop: Time = ...,
        statistics: list[StatisticDataPoint] = ...,
        check_fields: bool = ...,
    ) -> None: ...
