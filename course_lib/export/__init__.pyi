from .check import lacks as lacks
from .export import export as export
