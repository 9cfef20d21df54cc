#!/usr/bin/env bash
# The wheels of build/wheels, each in a new virtual environment of its Python, away from this tree:
#   bash tests/wheel/venvs.sh [PYTHON...|all]   .venv's Python unless told; roots.sh does it in systems without PCL
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
pythons=$(bash third_party/pythons.sh "$@")
pip=$PWD/build/wheel_tools/bin/pip  # wheel.sh makes it

for python in $pythons; do
  tag=$("$python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  wheel=$(ls build/wheels/pdoik-*-"$tag"-"$tag"-*.whl)
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  "$python" -m venv --without-pip "$work/venv"
  cp tests/wheel/smoke.py "$work/"
  whats=("" all)
  [[ $tag != cp315 ]] || whats=("")  # PyPI has no h5py for it yet
  for what in "${whats[@]}"; do
    "$pip" --python "$work/venv" --quiet --disable-pip-version-check install "$wheel${what:+[$what]}"
    (cd "$work" && env -u PYTHONPATH venv/bin/python smoke.py $what)
  done
  if [[ $(ls "$work"/venv/lib/python3*/site-packages/pdoik/_core*.so | wc -l) != 1 ]]; then
    echo "$wheel has a module that is not its own" >&2
    exit 1
  fi
  if ldd "$work"/venv/lib/python3*/site-packages/pdoik/_core*.so | grep -E 'pcl|urdf|yaml|lz4' | grep -v pdoik.libs; then
    echo "$wheel loads the above of the system" >&2
    exit 1
  fi
  rm -rf "$work"
done
