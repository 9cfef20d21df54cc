#!/usr/bin/env bash
# Installs the Debian packages of a list that are missing:
#   bash third_party/debian.sh FILE      one name a line
set -euo pipefail
list=${1:?"a file with the names of packages"}

missing=()
while read -r package; do
  [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
done < <(grep -v '^#' "$list")
((${#missing[@]})) || exit 0
sudo=()
[[ $(id -u) == 0 ]] || sudo=(sudo)
printf '== installing Debian packages, which takes some minutes: %s\n' "${missing[*]}"
quiet=(-qq -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=600)
log=$(mktemp)
{
  "${sudo[@]}" apt-get "${quiet[@]}" update &&
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get "${quiet[@]}" install -y --no-install-recommends "${missing[@]}"
} >"$log" 2>&1 || { tail -n 40 "$log" >&2; exit 1; }
rm -f "$log"
