#!/usr/bin/env bash
# Builds the documentation's site into build/site (index: python/docs/index.html), offline; a warning is an error.
# bash python/docs/build.sh [EXTRAS]      extras of pyproject.toml to set up first: docs,sim2real without it
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bash third_party/setup.sh --extras "${1:-docs,sim2real}"
export OMP_NUM_THREADS=1
.venv/bin/python python/docs/study_page.py
.venv/bin/python python/docs/effects_pages.py
rm -rf build/site
.venv/bin/sphinx-build --fail-on-warning --keep-going --quiet -b html -c python/docs . build/site
