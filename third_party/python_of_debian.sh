#!/usr/bin/env bash
# CPython of another Debian release, for wheels that need no newer C library than this system's:
#   bash third_party/python_of_debian.sh trixie 3.13      build/pythons/3.13/usr/bin/python3.13
# It brings the C library that it was compiled for and runs with that; what is compiled for it here does not.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
release=${1:?"a Debian release"} version=${2:?"a version, such as 3.13"}
root=$PWD/build/pythons/$version
[[ ! -d $root ]] || exit 0

command -v patchelf >/dev/null || apt-get install -qq -y --no-install-recommends patchelf >/dev/null
bash third_party/unpack_debian.sh "$root.new" "$release" "$(dpkg --print-architecture)" whole "python$version-dev"
loader=$(patchelf --print-interpreter "$root.new/usr/bin/python$version")
libraries=$(cd "$root.new" && find usr/lib -name 'libc.so.6' -printf '%h')
patchelf --set-interpreter "$root$loader" --force-rpath --set-rpath "$root/$libraries" "$root.new/usr/bin/python$version"
# Its pyconfig.h includes that of the architecture by where Debian installs it.
architecture=$(basename "$libraries")
mkdir "$root.new/usr/include/python$version/$architecture"
ln -s "../../$architecture/python$version" "$root.new/usr/include/python$version/$architecture/"
mv "$root.new" "$root"
"$root/usr/bin/python$version" --version
