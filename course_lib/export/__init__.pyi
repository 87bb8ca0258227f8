from .export import export as export
from .export import lacks as lacks
