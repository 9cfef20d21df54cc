#!/usr/bin/env bash
# Writes python/pdoik/_core.pyi from the module installed in .venv; --check only tells whether it would change.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
stubs=$(mktemp -d)
trap 'rm -rf "$stubs"' EXIT
.venv/bin/pybind11-stubgen pdoik._core --output-dir "$stubs" --exit-code
if [[ ${1-} == --check ]]; then
  diff -u python/pdoik/_core.pyi "$stubs/pdoik/_core.pyi" ||
    { echo "python/pdoik/_core.pyi is not what the bindings say: bash python/bindings/stubs.sh" >&2; exit 1; }
else
  cp "$stubs/pdoik/_core.pyi" python/pdoik/_core.pyi
fi
