#!/usr/bin/env bash
# CPython of another Debian release, compiled here, so that a wheel for it needs no newer C library than this system's:
#   bash third_party/python_of_debian.sh trixie 3.13      into build/pythons/3.13
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
release=${1:?"a Debian release"} version=${2:?"a version, such as 3.13"}
prefix=$PWD/build/pythons/$version
[[ ! -x $prefix/bin/python3 ]] || exit 0

apt-get install -qq -y --no-install-recommends dpkg-dev libffi-dev libssl-dev zlib1g-dev >/dev/null
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mirror=$(apt-get indextargets --format '$(SITE)' | grep -m1 -v security)
mkdir -p "$work/lists/partial"
echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $release main" >"$work/sources.list"
apt=(-qq -o "Dir::Etc::SourceList=$work/sources.list" -o Dir::Etc::SourceParts=/dev/null
  -o "Dir::State::Lists=$work/lists" -o APT::Sandbox::User=root)
apt-get "${apt[@]}" update
(cd "$work" && apt-get "${apt[@]}" source --download-only "python$version" >/dev/null)
mkdir "$work/source"
tar -C "$work/source" --strip-components=1 -xf "$work"/python"$version"_*.orig.tar.xz

cd "$work/source"
./configure --prefix="$prefix.part" >"$work/log" 2>&1
make -j "$(nproc)" >>"$work/log" 2>&1
make install >>"$work/log" 2>&1 || { tail "$work/log" >&2; exit 1; }
rm -rf "$prefix"
mv "$prefix.part" "$prefix"
"$prefix/bin/python3" --version
