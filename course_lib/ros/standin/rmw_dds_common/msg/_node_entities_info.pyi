# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from rmw_dds_common.msg._gid import Gid

class NodeEntitiesInfo(Message):
    node_namespace: str
    node_name: str
    reader_gid_seq: list[Gid]
    writer_gid_seq: list[Gid]
    def __init__(
        self,
        *,
        node_namespace: str = ...,
        node_name: str = ...,
        reader_gid_seq: list[Gid] = ...,
        writer_gid_seq: list[Gid] = ...,
        check_fields: bool = ...,
    ) -> None: ...
