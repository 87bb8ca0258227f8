# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._gid import Gid as Gid
from ._node_entities_info import NodeEntitiesInfo as NodeEntitiesInfo
from ._participant_entities_info import ParticipantEntitiesInfo as ParticipantEntitiesInfo
