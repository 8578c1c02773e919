#!/bin/sh
# Fetches the heights of Trinidad, Colorado (USGS, public domain) from Debian's libncarg-data into OUT_DIR/data, unless they are there,
# and prints their path. Usage: trinidad.sh OUT_DIR.
set -eu
out=$1
package=libncarg-data
dem=$out/data/usr/share/ncarg/data/cdf/trinidad.nc

fail() { printf 'trinidad: %s\n' "$*" >&2; exit 1; }

if [ ! -f "$dem" ]; then
    mkdir -p "$out/data"
    (cd "$out/data" && apt-get download -qq "$package" >/dev/null 2>&1) || fail "cannot download the package $package"
    dpkg-deb -x "$out"/data/${package}_*.deb "$out/data"
    rm -f "$out"/data/${package}_*.deb
    [ -f "$dem" ] || fail "the package $package holds no trinidad.nc"
fi
printf '%s\n' "$dem"
