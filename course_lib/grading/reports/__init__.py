"""What people read of results: tables, pages, the gradebook and the terminal's lines."""
