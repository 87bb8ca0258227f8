# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._floating_point_range import FloatingPointRange as FloatingPointRange
from ._integer_range import IntegerRange as IntegerRange
from ._list_parameters_result import ListParametersResult as ListParametersResult
from ._log import Log as Log
from ._logger_level import LoggerLevel as LoggerLevel
from ._parameter import Parameter as Parameter
from ._parameter_descriptor import ParameterDescriptor as ParameterDescriptor
from ._parameter_event import ParameterEvent as ParameterEvent
from ._parameter_event_descriptors import ParameterEventDescriptors as ParameterEventDescriptors
from ._parameter_type import ParameterType as ParameterType
from ._parameter_value import ParameterValue as ParameterValue
from ._set_logger_levels_result import SetLoggerLevelsResult as SetLoggerLevelsResult
from ._set_parameters_result import SetParametersResult as SetParametersResult
