"""How Sphinx builds the pages: `python -m sphinx -W docs docs/_build`; nothing is fetched, neither now nor by who reads them."""

import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from docs import mathml  # noqa: E402 (found beside this file)

from duhem.version import __version__  # noqa: E402

project = "duhem"
author = copyright = "The duhem developers"
version = release = __version__

extensions = ["myst_nb"]
exclude_patterns = ["_build", "paper"]
nb_execution_mode = "off"  # notebooks are kept with their outputs, which tests make again
nb_mime_priority_overrides = [("html", "text/markdown", 5)]  # before HTML, whose formulas wait for a script
nb_render_markdown_format = "myst"  # with formulas and tables
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
smartquotes = False  # --out is an option
suppress_warnings = ["mystnb.unknown_mime_type"]

html_theme = "furo"
html_title = f"duhem {__version__}"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False


def setup(app):
    """The notebooks beside the pages, and formulas as MathML."""
    course = Path(app.srcdir) / "course"
    shutil.rmtree(course / "notebooks", ignore_errors=True)
    shutil.copytree(ROOT / "notebooks", course / "notebooks", ignore=shutil.ignore_patterns(".*"))
    mathml.setup(app)
