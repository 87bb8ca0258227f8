"""The wall clock for all threads, kept before `virtual_time` puts robot time behind the usual names."""

import time

monotonic = time.monotonic
sleep = time.sleep
time_ns = time.time_ns
