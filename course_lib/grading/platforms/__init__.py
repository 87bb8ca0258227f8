"""Grading elsewhere: autograders for Gradescope, workflows for GitHub."""
