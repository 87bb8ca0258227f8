# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._metrics_message import MetricsMessage as MetricsMessage
from ._statistic_data_point import StatisticDataPoint as StatisticDataPoint
from ._statistic_data_type import StatisticDataType as StatisticDataType
