#!/usr/bin/env bash
# Sets everything up, then runs the demo: bash bench/demo.sh [arguments of bench.ik.demo]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bash third_party/setup.sh
exec .venv/bin/python -B -m bench.ik.demo "$@"
