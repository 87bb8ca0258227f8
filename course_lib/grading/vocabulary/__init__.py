"""Words that check files are written in; each returns a `Check`. `course_lib.grading` exports them."""
