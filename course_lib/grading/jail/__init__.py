"""The sandbox of a student's code; one layer per file."""
