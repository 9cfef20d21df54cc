#!/usr/bin/env bash
# Sets everything up, then runs the demo: bash bench/demo.sh [arguments of bench/demo.py]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bash third_party/setup.sh
exec .venv/bin/python -B bench/demo.py "$@"
