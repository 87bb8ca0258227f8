# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message

class State(Message):
    PRIMARY_STATE_UNKNOWN: Final = 0
    PRIMARY_STATE_UNCONFIGURED: Final = 1
    PRIMARY_STATE_INACTIVE: Final = 2
    PRIMARY_STATE_ACTIVE: Final = 3
    PRIMARY_STATE_FINALIZED: Final = 4
    TRANSITION_STATE_CONFIGURING: Final = 10
    TRANSITION_STATE_CLEANINGUP: Final = 11
    TRANSITION_STATE_SHUTTINGDOWN: Final = 12
    TRANSITION_STATE_ACTIVATING: Final = 13
    TRANSITION_STATE_DEACTIVATING: Final = 14
    TRANSITION_STATE_ERRORPROCESSING: Final = 15
    id: int
    label: str
    def __init__(
        self,
        *,
        id: int = ...,
        label: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
