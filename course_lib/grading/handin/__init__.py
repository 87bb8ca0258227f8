"""Submissions: from a learning platform to what is graded, and marks back to it."""
