# Written by `python -m tests.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any
from typing import Final

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import builtin_interfaces.msg

class ServiceEventInfo(Message):
    REQUEST_SENT: Final = 0
    REQUEST_RECEIVED: Final = 1
    RESPONSE_SENT: Final = 2
    RESPONSE_RECEIVED: Final = 3
    event_type: int
    stamp: builtin_interfaces.msg.Time
    @property
    def client_gid(self) -> NDArray[np.uint8]: ...
    @client_gid.setter
    def client_gid(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    sequence_number: int
    def __init__(
        self,
        *,
        event_type: int = ...,
        stamp: builtin_interfaces.msg.Time = ...,
        client_gid: Sequence[int] | NDArray[Any] = ...,
        sequence_number: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
