"""Sphinx settings for a course's book. A course can import and override them in `docs/conf.py`."""

from pathlib import Path

from course_lib.course.course_file import shipped_course_file

project = shipped_course_file().title
html_title = project
extensions = ["myst_nb", "sphinx.ext.githubpages"]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb"}
exclude_patterns = ["conf.py"]

myst_enable_extensions = ["colon_fence", "deflist", "html_image"]
myst_heading_anchors = 4
# `course book` has run the lessons already.
nb_execution_mode = "off"
# Code blocks in a language that Pygments does not know are shown without colors.
suppress_warnings = ["misc.highlighting_failure"]
nb_merge_streams = True
# These options would load files from the network.
nb_ipywidgets_js: dict[str, dict[str, str]] = {}

html_theme = "sphinx_book_theme"
html_theme_options = {
    "footer_content_items": [],
    # The sidebar contains the search field.
    "navbar_persistent": [],
    "show_toc_level": 2,
    "use_download_button": False,
    "use_fullscreen_button": False,
}
html_static_path = [str(Path(__file__).parent / "static")]
html_css_files = ["book.css"]
html_js_files = ["pages.js"]
html_extra_path = ["_extra"]
# Sphinx's search summaries would request pages from a server.
html_show_search_summary = False
html_copy_source = False
html_show_copyright = False
