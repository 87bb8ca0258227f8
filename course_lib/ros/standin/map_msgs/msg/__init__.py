from course_lib.ros.messages.registry import import_types as _import_types

globals().update(_import_types(__name__))
