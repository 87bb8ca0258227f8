"""Where a student's code runs: the fewer rights, the better. One layer of the sandbox per file."""
