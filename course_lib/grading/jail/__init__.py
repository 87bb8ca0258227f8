"""The sandbox of student code.

Student code is treated as hostile. No single mechanism is available everywhere, so the jail is
built of independent layers: namespaces or bubblewrap (own file tree, no network), Landlock
(readable files), seccomp (system calls), and resource limits. Each layer is tried on this machine,
and the layers that work are part of the result. `filters.Isolation` decides whether they suffice.
"""
