"""Sphinx: the pages of this folder and the READMEs of bench as one site.

`bash python/docs/build.sh` builds it. The sources' root is the repository's, so that links between
its files are the site's, too.
"""

project = "pdoik"
author = "the pdoik developers"
extensions = ["myst_parser"]
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
html_title = "pdoik"
