# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message

class NavSatStatus(Message):
    STATUS_UNKNOWN: Final = -2
    STATUS_NO_FIX: Final = -1
    STATUS_FIX: Final = 0
    STATUS_SBAS_FIX: Final = 1
    STATUS_GBAS_FIX: Final = 2
    SERVICE_UNKNOWN: Final = 0
    SERVICE_GPS: Final = 1
    SERVICE_GLONASS: Final = 2
    SERVICE_COMPASS: Final = 4
    SERVICE_GALILEO: Final = 8
    STATUS__DEFAULT: Final = -2
    status: int
    service: int
    def __init__(
        self,
        *,
        status: int = ...,
        service: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
