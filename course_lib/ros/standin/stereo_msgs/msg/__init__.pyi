# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._disparity_image import DisparityImage as DisparityImage
