"""What tf2 raises; names, also that of the module in tracebacks, inheritance and texts are tf2's own."""


class TransformException(Exception):  # noqa: N818 - ROS's name
    """Base of everything that tf2 raises."""

    __module__ = "tf2"


class ConnectivityException(TransformException):
    """Two frames are not part of one tree."""

    __module__ = "tf2"


class LookupException(TransformException):
    """A frame does not exist, or the tree has a loop."""

    __module__ = "tf2"


class ExtrapolationException(TransformException):
    """There is no data at the requested time, nor on both sides of it."""

    __module__ = "tf2"


class InvalidArgumentException(TransformException):
    """A frame name that tf2 does not accept."""

    __module__ = "tf2"


class TimeoutException(TransformException):
    """A transform did not arrive in time."""

    __module__ = "tf2"
