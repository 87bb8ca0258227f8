# Written by `python -m tests.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import rmw_dds_common.msg

class Gid(Message):
    @property
    def data(self) -> NDArray[np.uint8]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(self, *, data: Sequence[int] | NDArray[Any] = ..., check_fields: bool = ...) -> None: ...

class NodeEntitiesInfo(Message):
    node_namespace: str
    node_name: str
    reader_gid_seq: list[rmw_dds_common.msg.Gid]
    writer_gid_seq: list[rmw_dds_common.msg.Gid]
    def __init__(
        self,
        *,
        node_namespace: str = ...,
        node_name: str = ...,
        reader_gid_seq: list[rmw_dds_common.msg.Gid] = ...,
        writer_gid_seq: list[rmw_dds_common.msg.Gid] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class ParticipantEntitiesInfo(Message):
    gid: rmw_dds_common.msg.Gid
    node_entities_info_seq: list[rmw_dds_common.msg.NodeEntitiesInfo]
    def __init__(
        self,
        *,
        gid: rmw_dds_common.msg.Gid = ...,
        node_entities_info_seq: list[rmw_dds_common.msg.NodeEntitiesInfo] = ...,
        check_fields: bool = ...,
    ) -> None: ...
