# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._diagnostic_array import DiagnosticArray as DiagnosticArray
from ._diagnostic_status import DiagnosticStatus as DiagnosticStatus
from ._key_value import KeyValue as KeyValue
