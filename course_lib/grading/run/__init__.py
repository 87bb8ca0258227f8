"""Running a submission: the worker in the jail, the clock and recorder outside, evidence as a file."""
