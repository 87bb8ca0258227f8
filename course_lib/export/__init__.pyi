from .export import check_package as check_package
from .export import export as export
