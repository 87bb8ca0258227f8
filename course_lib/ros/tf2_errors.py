"""What tf2 raises; names, also that of the module in tracebacks, inheritance and texts are tf2's own."""


class TransformException(Exception):  # noqa: N818 - ROS's name
    """Base of everything that tf2 raises."""


class ConnectivityException(TransformException):
    """Two frames are not part of one tree."""


class LookupException(TransformException):
    """A frame does not exist, or the tree has a loop."""


class ExtrapolationException(TransformException):
    """There is no data at the requested time, nor on both sides of it."""


class InvalidArgumentException(TransformException):
    """A frame name that tf2 does not accept."""


class TimeoutException(TransformException):
    """A transform did not arrive in time."""


for _error in (TransformException, *TransformException.__subclasses__()):
    _error.__module__ = "tf2"
