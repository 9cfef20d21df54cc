"""Sphinx: the pages of this folder and the READMEs of bench as one site.

`bash python/docs/build.sh` builds it. The sources' root is the repository's, so that links between
its files are the site's, too.
"""

from __future__ import annotations

import re
from typing import Any

project = "pdoik"
author = "the pdoik developers"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300  # [s] a cell
nb_merge_streams = True
autodoc_typehints = "description"
autodoc_member_order = "bysource"
myst_heading_anchors = 3
root_doc = "python/docs/index"
include_patterns = [
    "python/docs/**/*.md",
    "python/docs/*.md",
    "bench/README.md",
    "bench/**/README.md",
    "third_party/README.md",
    "tests/fuzz/README.md",
]
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["wide.css"]
html_title = "pdoik"
html_show_copyright = False


def setup(app: Any) -> None:
    """The signatures that pybind11 writes above each overload are no text."""
    app.connect("autodoc-process-docstring", _overloads_as_code)


def _overloads_as_code(
    _app: Any, _what: Any, _name: Any, _obj: Any, _to: Any, lines: list[str]
) -> None:
    lines[:] = [re.sub(r"^(\d+\. )(\w+\(.*)$", r"\1``\2``", line) for line in lines]
