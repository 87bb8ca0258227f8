"""Pages, tables, the gradebook, and lines for the terminal."""
