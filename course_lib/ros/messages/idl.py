"""The types of message fields, as in IDL."""

from dataclasses import dataclass


class AbstractType:
    """Base class of all types."""


class AbstractNestableType(AbstractType):
    """Base class of types that arrays and sequences can contain."""


@dataclass(frozen=True)
class BasicType(AbstractNestableType):
    """A number, a boolean or an octet, such as `double`, `boolean` or `int32`."""

    typename: str


@dataclass(frozen=True)
class NamedType(AbstractNestableType):
    """A type given by its name only."""

    name: str


@dataclass(frozen=True)
class NamespacedType(AbstractNestableType):
    """A message type given by package, folder and name."""

    namespaces: list[str]
    name: str

    def namespaced_name(self) -> tuple[str, ...]:
        """Return the package, folder and name."""
        return (*self.namespaces, self.name)


class AbstractGenericString(AbstractNestableType):
    """Base class of strings."""

    def has_maximum_size(self) -> bool:
        """Return whether the length is bounded."""
        return isinstance(self, BoundedString)


class AbstractString(AbstractGenericString):
    """Base class of strings of 8-bit characters."""


@dataclass(frozen=True)
class BoundedString(AbstractString):
    """A string of at most `maximum_size` characters."""

    maximum_size: int


@dataclass(frozen=True)
class UnboundedString(AbstractString):
    """A string of any length."""


@dataclass(frozen=True)
class AbstractNestedType(AbstractType):
    """Base class of types that contain several values of one type."""

    value_type: AbstractNestableType

    def has_maximum_size(self) -> bool:
        """Return whether the length is bounded."""
        return not isinstance(self, UnboundedSequence)


@dataclass(frozen=True)
class Array(AbstractNestedType):
    """An array of a fixed length."""

    size: int


class AbstractSequence(AbstractNestedType):
    """Base class of sequences."""


@dataclass(frozen=True)
class BoundedSequence(AbstractSequence):
    """A sequence of at most `maximum_size` values."""

    maximum_size: int


@dataclass(frozen=True)
class UnboundedSequence(AbstractSequence):
    """A sequence of any length."""
