# Written by `python -m tests.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import builtin_interfaces.msg
import std_msgs.msg

class Bool(Message):
    data: bool
    def __init__(self, *, data: bool = ..., check_fields: bool = ...) -> None: ...

class Byte(Message):
    data: bytes
    def __init__(self, *, data: bytes = ..., check_fields: bool = ...) -> None: ...

class ByteMultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    data: list[bytes]
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: list[bytes] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Char(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class ColorRGBA(Message):
    r: float
    g: float
    b: float
    a: float
    def __init__(
        self,
        *,
        r: float = ...,
        g: float = ...,
        b: float = ...,
        a: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Empty(Message):
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class Float32(Message):
    data: float
    def __init__(self, *, data: float = ..., check_fields: bool = ...) -> None: ...

class Float32MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[float]: ...
    @data.setter
    def data(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Float64(Message):
    data: float
    def __init__(self, *, data: float = ..., check_fields: bool = ...) -> None: ...

class Float64MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[float]: ...
    @data.setter
    def data(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Header(Message):
    stamp: builtin_interfaces.msg.Time
    frame_id: str
    def __init__(
        self,
        *,
        stamp: builtin_interfaces.msg.Time = ...,
        frame_id: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Int16(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class Int16MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Int32(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class Int32MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Int64(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class Int64MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Int8(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class Int8MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class MultiArrayDimension(Message):
    label: str
    size: int
    stride: int
    def __init__(
        self,
        *,
        label: str = ...,
        size: int = ...,
        stride: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class MultiArrayLayout(Message):
    dim: list[std_msgs.msg.MultiArrayDimension]
    data_offset: int
    def __init__(
        self,
        *,
        dim: list[std_msgs.msg.MultiArrayDimension] = ...,
        data_offset: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class String(Message):
    data: str
    def __init__(self, *, data: str = ..., check_fields: bool = ...) -> None: ...

class UInt16(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class UInt16MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class UInt32(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class UInt32MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class UInt64(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class UInt64MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class UInt8(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class UInt8MultiArray(Message):
    layout: std_msgs.msg.MultiArrayLayout
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: std_msgs.msg.MultiArrayLayout = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
