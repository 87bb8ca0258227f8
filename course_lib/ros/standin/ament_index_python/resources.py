"""Resource markers of packages in the ament index."""

from ament_index_python.packages import get_packages_with_prefixes

_PACKAGES = "packages"


def get_resource_types() -> set[str]:
    """Return the types of resources. This index contains packages only."""
    return {_PACKAGES}


def has_resource(resource_type: str, resource_name: str) -> str | None:
    """Return the prefix of a resource, or None if there is none."""
    return get_resources(resource_type).get(resource_name)


def get_resource(resource_type: str, resource_name: str) -> tuple[str, str]:
    """Return the content of a package's marker, which is empty, and its prefix.

    Raises:
        LookupError: There is no such resource.
    """
    prefix = has_resource(resource_type, resource_name)
    if prefix is None:
        raise LookupError(
            f"Could not find the resource '{resource_name}' of type '{resource_type}'. Resources "
            f"of this index are of the type '{_PACKAGES}'."
        )
    return "", prefix


def get_resources(resource_type: str) -> dict[str, str]:
    """Return all resources of a type as a dictionary of name to prefix."""
    return dict(get_packages_with_prefixes()) if resource_type == _PACKAGES else {}
