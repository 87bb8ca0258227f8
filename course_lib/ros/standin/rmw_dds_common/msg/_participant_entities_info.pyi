# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from rmw_dds_common.msg._gid import Gid
from rmw_dds_common.msg._node_entities_info import NodeEntitiesInfo

class ParticipantEntitiesInfo(Message):
    gid: Gid
    node_entities_info_seq: list[NodeEntitiesInfo]
    def __init__(
        self,
        *,
        gid: Gid = ...,
        node_entities_info_seq: list[NodeEntitiesInfo] = ...,
        check_fields: bool = ...,
    ) -> None: ...
