# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._mesh import Mesh as Mesh
from ._mesh_triangle import MeshTriangle as MeshTriangle
from ._plane import Plane as Plane
from ._solid_primitive import SolidPrimitive as SolidPrimitive
