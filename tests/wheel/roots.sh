#!/usr/bin/env bash
# The wheels of build/wheels, installed and tried where nothing but Debian's Python is:
#   bash tests/wheel/roots.sh           in roots of Debian 12 and 13, made by debootstrap; takes root's rights
# Debian 12 has Python 3.11 and Debian 13 has 3.13; a root whose Python has no wheel here is left out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
command -v debootstrap >/dev/null || apt-get install -qq -y --no-install-recommends debootstrap >/dev/null
mirror=$(apt-get indextargets --format '$(SITE)' | grep -m1 -v security)
mkdir -p build/roots
tried=0
for release in bookworm trixie; do
  if [[ $release == bookworm ]]; then tag=cp311; else tag=cp313; fi
  if ! compgen -G "build/wheels/pdoik-*-$tag-$tag-*.whl" >/dev/null; then
    printf -- '-- %s: no wheel of %s in build/wheels\n' "$release" "$tag"
    continue
  fi
  tried=$((tried + 1))
  root=$PWD/build/roots/$release
  if [[ ! -d $root ]]; then
    rm -rf "$root.part"
    debootstrap --variant=minbase --include=python3,python3-venv,ca-certificates "$release" "$root.part" "$mirror" \
      >"build/roots/$release.log"
    mv "$root.part" "$root"
  fi
  if find "$root/usr/lib" -name 'libpcl*' | grep -q .; then
    echo "$release has PCL, so it shows nothing" >&2
    exit 1
  fi
  rm -rf "$root/wheel" "$root/venv"
  mkdir "$root/wheel"
  cp build/wheels/pdoik-*-"$tag-$tag"-*.whl tests/wheel/smoke.py "$root/wheel/"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  for file in /etc/pip.conf /etc/ssl/certs/ca-certificates.crt; do
    if [[ -f $file ]]; then cp "$file" "$root$file"; fi
  done
  inside() { chroot "$root" env -u PIP_FIND_LINKS PATH=/venv/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root "$@"; }
  pip=(pip --quiet --disable-pip-version-check install --find-links /wheel)
  printf '== %s\n' "$release"
  inside python3 -m venv /venv
  inside "${pip[@]}" pdoik
  inside python /wheel/smoke.py
  inside apt-get -qq -o APT::Sandbox::User=root install -y --no-install-recommends libgomp1 >/dev/null 2>&1  # pin's wheel loads it
  inside "${pip[@]}" 'pdoik[all]'
  inside python /wheel/smoke.py all
done
((tried)) || { echo "roots.sh: build/wheels has no wheel for a Python of Debian 12 or 13" >&2; exit 1; }
