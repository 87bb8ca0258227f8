"""Controls of cells that ipywidgets has none of its own for."""
