"""Sphinx's settings of the kit's own book; `course book OUT` builds it."""

import sys
from pathlib import Path

from course_lib.book import settings
from course_lib.book.settings import *  # noqa: F403

sys.path.insert(0, str(Path(__file__).parent))  # for generated.py and gallery.py
extensions = [*settings.extensions, "sphinx.ext.autodoc", "sphinx.ext.napoleon", "generated"]
html_static_path = [*settings.html_static_path, "_static"]
html_css_files = [*settings.html_css_files, "kit.css"]
html_search_scorer = str(
    Path(__file__).parent / "_static" / "scorer.js"
)  # Sphinx opens it from where it runs
default_role = "code"  # of `names` in docstrings
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints_format = "short"
napoleon_use_rtype = False
