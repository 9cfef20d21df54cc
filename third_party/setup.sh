#!/usr/bin/env bash
# Sets up everything that building, testing and running pdoik takes, and does nothing where it is there already:
#   1. the Debian packages of debian.txt that are missing,
#   2. .venv, with the Python packages of pyproject.toml,
#   3. pdoik itself, built from this tree and installed into .venv; again whenever a source changed.
# bash third_party/setup.sh [--extras NAME[,NAME...]]      extras of pyproject.toml: all, test, bench, peers; cli, files, plot unless told
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$PWD
venv=$root/.venv

extras="cli,files,plot"
case ${1-} in
  "") ;;
  --extras) extras=${2:?"--extras wants names, such as test"} ;;
  *) echo "setup.sh: unknown argument $1" >&2; exit 2 ;;
esac

say() { printf '== %s\n' "$*"; }

make_venv() {
  local at_least_311='import sys; sys.exit(sys.version_info < (3, 11))'
  if grep -qsF "$venv" "$venv/bin/activate" && "$venv/bin/python" -c "$at_least_311; import pip"; then
    return 0
  fi
  local python
  python=$(command -v python3)
  "$python" -c "$at_least_311" || python=/usr/bin/python3
  say "making .venv with $("$python" --version)"
  rm -rf "$venv" build  # made by another Python or for another place: so is what CMake remembers of it
  "$python" -m venv "$venv"
}

hash_of() { find "$@" -type f ! -path '*/__pycache__/*' -print0 | sort -z | xargs -0 sha256sum | sha256sum; }

# A stamp holds what was installed; it is written last, so an interrupted run starts again.
is_current() { [[ -f $1 && $(<"$1") == "$2" ]]; }

install_pdoik() {
  local dependencies sources
  dependencies=$(hash_of pyproject.toml)
  sources=$(hash_of CMakeLists.txt pyproject.toml cpp python)
  local dependencies_stamp=$venv/stamp-dependencies-$extras sources_stamp=$venv/stamp-sources
  local pip=("$venv/bin/python" -m pip --disable-pip-version-check install --quiet)
  if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi

  if ! is_current "$dependencies_stamp" "$dependencies"; then
    say "installing Python packages and building pdoik into .venv"
    local build_requires
    mapfile -t build_requires < <("$venv/bin/python" -c '
import tomllib
print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")')
    "${pip[@]}" "${build_requires[@]}"
    "${pip[@]}" --no-build-isolation ".${extras:+[$extras]}"
    echo "$dependencies" >"$dependencies_stamp"
  elif ! is_current "$sources_stamp" "$sources"; then
    say "a source changed: building pdoik into .venv again"
    "${pip[@]}" --no-build-isolation --no-deps --force-reinstall .
  fi
  echo "$sources" >"$sources_stamp"
}

bash third_party/debian.sh third_party/debian.txt
make_venv
install_pdoik
