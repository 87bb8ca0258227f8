"""The wall clock, for all threads.

Imported before `virtual_time` replaces the functions of `time`.
"""

import time

monotonic = time.monotonic
sleep = time.sleep
time_ns = time.time_ns
