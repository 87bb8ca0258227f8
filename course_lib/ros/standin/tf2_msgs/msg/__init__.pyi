# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._tf2_error import TF2Error as TF2Error
from ._tf_message import TFMessage as TFMessage
