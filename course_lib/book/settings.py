"""Sphinx's settings of a course's book; `docs/conf.py` of a course may import them and change some."""

from pathlib import Path

from course_lib.course.course_file import shipped_course_file

project = shipped_course_file().title
html_title = project
extensions = ["myst_nb", "sphinx.ext.githubpages"]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb"}
exclude_patterns = ["conf.py"]

myst_enable_extensions = ["colon_fence", "deflist", "html_image"]
myst_heading_anchors = 4
nb_execution_mode = "off"  # `course book` has run the lessons
suppress_warnings = ["misc.highlighting_failure"]  # blocks of an unusual language stay without colours
nb_merge_streams = True
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # they come from a network

html_theme = "sphinx_book_theme"
html_theme_options = {
    "footer_content_items": [],
    "navbar_persistent": [],  # the search is in the side bar
    "show_toc_level": 2,
    "use_download_button": False,
    "use_fullscreen_button": False,
}
html_static_path = [str(Path(__file__).parent / "static")]
html_css_files = ["book.css"]
html_js_files = ["pages.js"]
html_extra_path = ["_extra"]
html_show_search_summary = False  # it would ask a server for pages
html_copy_source = False
html_show_copyright = False
