#!/usr/bin/env bash
# Unpacks packages of a Debian release for an architecture into a new directory; nothing of them is installed:
#   bash third_party/unpack_debian.sh DIRECTORY RELEASE ARCHITECTURE alone|whole PACKAGE...
# alone takes the packages named, whole what they depend on besides. CMake files in them that name absolute places are
# given those in the directory.
set -euo pipefail
root=$(realpath -m "${1:?"a directory"}") release=${2:?"a release"} architecture=${3:?"an architecture"} which=${4:?"alone or whole"}
shift 4

# apt with lists of its own and nothing installed, as if on such a machine.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{lists,archives}/partial
: >"$work/status"
mirror=$(apt-get indextargets --format '$(SITE)' | grep -m1 -v security)
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $release main" >"$work/sources.list"
apt=(-qq -o "Dir::Etc::SourceList=$work/sources.list" -o Dir::Etc::SourceParts=/dev/null -o "APT::Architecture=$architecture"
  -o "APT::Architectures::=$architecture" -o "Dir::State::status=$work/status" -o "Dir::State::Lists=$work/lists"
  -o "Dir::Cache::archives=$work/archives" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root)
apt-get "${apt[@]}" update
if [[ $which == alone ]]; then
  (cd "$work/archives" && apt-get "${apt[@]}" download "$@")
else
  apt-get "${apt[@]}" install -y --download-only --no-install-recommends "$@" >/dev/null
fi

rm -rf "$root" "$root.part"
mkdir -p "$root.part"/usr/{bin,lib,lib64,sbin}
for directory in bin lib lib64 sbin; do ln -s "usr/$directory" "$root.part/$directory"; done
for package in "$work"/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar -C "$root.part" -x --keep-directory-symlink
done
find "$root.part/usr" -name '*.cmake' -exec sed -i "s|\\([\";]\\)/usr\\([/\"]\\)|\\1$root/usr\\2|g" {} +
mv "$root.part" "$root"
