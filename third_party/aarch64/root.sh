#!/usr/bin/env bash
# Debian's arm64 libraries that pdoik is compiled against, in build/aarch64/root:
#   bash third_party/aarch64/root.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=../build/aarch64/root
stamp=$(sha256sum aarch64/arm64.txt aarch64/root.sh unpack_debian.sh)
[[ ! -f $root.stamp || $(<"$root.stamp") != "$stamp" ]] || exit 0
rm -f "$root.stamp"
mapfile -t packages < <(grep -v '^#' aarch64/arm64.txt)
bash unpack_debian.sh "$root" bookworm arm64 alone "${packages[@]}"
echo "$stamp" >"$root.stamp"
