from course_lib.ros.messages.registry import import_messages as _import_messages

globals().update(_import_messages(__name__))
