#!/usr/bin/env bash
# The Pythons to make wheels for, one path a line:
#   bash third_party/pythons.sh               .venv's
#   bash third_party/pythons.sh PYTHON...     those told
#   bash third_party/pythons.sh all           every CPython from 3.10 on that this machine has or a Debian release gives
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [[ $* != all ]]; then
  printf '%s\n' "${@:-.venv/bin/python}"
  exit
fi

declare -A debian=([3.11]=bookworm [3.13]=trixie [3.14]=forky [3.15]=forky)  # the release that has it

can_be_compiled_for='
import os, sys, sysconfig
headers = os.path.join(sysconfig.get_path("include"), "Python.h")
sys.exit(not os.path.exists(headers) or bool(sysconfig.get_config_var("Py_GIL_DISABLED")))'

of_this_machine() {  # VERSION
  local python
  for python in "$(command -v "python$1")" "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/bin/"python$1" \
    "$HOME/.local/share/uv/python/cpython-$1".*/bin/"python$1"; do
    if "$python" -c "$can_be_compiled_for" 2>/dev/null; then
      "$python" -c 'import sys; print(sys.executable)'
      return 0
    fi
  done
  return 1
}

for version in 3.10 3.11 3.12 3.13 3.14 3.15; do
  if of_this_machine "$version"; then continue; fi
  if [[ ! ${debian[$version]-} ]]; then
    echo "no CPython $version: pyenv and uv have it" >&2
    continue
  fi
  bash third_party/python_of_debian.sh "${debian[$version]}" "$version" >&2
  echo "$PWD/build/pythons/$version/usr/bin/python$version"
done
