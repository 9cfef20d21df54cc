#!/usr/bin/env bash
# Builds the documentation's site, offline; a warning is an error.
# bash python/docs/build.sh [DIRECTORY]      build/site without it; index: python/docs/index.html
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bash third_party/setup.sh --extras docs,sim2real
.venv/bin/python python/docs/study_page.py
.venv/bin/python python/docs/effects_pages.py
.venv/bin/sphinx-build --fail-on-warning --keep-going --quiet -b html -c python/docs . "${1:-build/site}"
