"""Sphinx: the pages of this folder and the READMEs of bench as one site.

`bash python/docs/build.sh` builds it. The sources' root is the repository's, so that links between
its files are the site's, too.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

from sphinx.errors import ExtensionError
from sphinx.ext import autosummary

project = "pdoik"
author = "the pdoik developers"
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "breathe",
]
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300  # [s] a cell
nb_merge_streams = True
autosummary_generate = False  # tables only
autosummary.WELL_KNOWN_ABBREVIATIONS += ("Eq.", "Sec.")  # these end no sentence
autodoc_typehints = "description"
autodoc_member_order = "bysource"
myst_heading_anchors = 3
breathe_projects = {"pdoik": str(Path(__file__).parents[2] / "build" / "doxygen" / "xml")}
breathe_default_project = "pdoik"
breathe_default_members = ("members",)
breathe_domain_by_extension = {"hpp": "cpp"}
root_doc = "python/docs/index"
include_patterns = [
    "python/docs/**/*.md",
    "python/docs/*.md",
    "python/docs/cpp_reference/*.rst",
    "bench/README.md",
    "bench/**/README.md",
    "third_party/README.md",
    "tests/fuzz/README.md",
]
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["wide.css"]
html_js_files = ["old_addresses.js"]
html_title = "pdoik"
html_show_copyright = False


def setup(app: Any) -> None:
    """The public headers as Doxygen reads them; signatures of pybind11's overloads as code."""
    app.connect("config-inited", _read_headers)
    app.connect("autodoc-process-docstring", _overloads_as_code)


def _read_headers(_app: Any, _config: Any) -> None:
    """For breathe; what Doxygen has to say of comments fails the build."""
    if shutil.which("doxygen") is None:
        raise ExtensionError("doxygen is not installed: third_party/debian.txt lists it")
    root = Path(__file__).parents[2]
    (root / "build").mkdir(exist_ok=True)
    done = subprocess.run(
        ["doxygen", "python/docs/Doxyfile"], cwd=root, capture_output=True, text=True
    )
    if done.returncode:
        raise ExtensionError(f"the comments of cpp/include:\n{done.stderr}")


def _overloads_as_code(
    _app: Any, _what: Any, _name: Any, _obj: Any, _to: Any, lines: list[str]
) -> None:
    lines[:] = [re.sub(r"^(\d+\. )(\w+\(.*)$", r"\1``\2``", line) for line in lines]
