# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._service_event_info import ServiceEventInfo as ServiceEventInfo
