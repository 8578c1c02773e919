#!/bin/bash
# make install into an empty folder, a stranger's program built against it with pkg-config, make uninstall.
set -u
cd "$(dirname "$0")/../.." || exit 2
work=$PWD/build/tests/install
. tests/rig/result.bash
unset MAKEFLAGS MFLAGS MAKELEVEL
rm -rf "$work"
mkdir -p "$work"
root=$work/root

make BUILD=build install PREFIX=/opt/ff DESTDIR="$root" >"$work/make.log" 2>&1
installed=$?
result $installed "make install"
[ $installed = 0 ] || tail "$work/make.log"
[ -z "$(find "$root" -mindepth 1 -maxdepth 1 ! -name opt)" ]; result $? "nothing lies outside PREFIX"
for program in build/bin/farfield-*; do
    name=$(basename "$program")
    page=$root/opt/ff/share/man/man1/$name.1
    [ -x "$root/opt/ff/bin/$name" ] && grep -q '^.SH SYNOPSIS' "$page" && ! sed -n '/^.SH NAME/{n;p;}' "$page" | grep -q '\. '
    result $? "$name and its manual page"
done
[ "$(readlink "$root/opt/ff/lib/libfarfield.so")" = libfarfield.so.0 ] && [ -e "$root/opt/ff/lib/libfarfield.so.0" ] &&
    [ -s "$root/opt/ff/lib/libfarfield.a" ]
result $? "libfarfield, static and shared"
if command -v man >/dev/null; then
    for page in "$root"/opt/ff/share/man/man1/*.1; do
        MANROFFSEQ='' man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null
    done >"$work/man.log"
    [ ! -s "$work/man.log" ]; result $? "manual pages without warnings"
fi

cat >"$work/stranger.c" <<'END'
#include <farfield.h>

#include <stdio.h>

static _Alignas(16) unsigned char block[8 << 20];

int main(void)
{
    ff_client_desc desc = {0};
    ff_client *client;
    c3d_camera camera = {.pos_wu = {0, 0, 256 * 500}, .focal_q8 = 240 * 256, .width = 240, .height = 320};
    desc.memory = block;
    desc.memory_bytes = sizeof block;
    if (ff_client_bytes_min() > sizeof block) return 1;
    int rc = ff_client_create(&desc, &client);
    if (rc < 0) { printf("Farfield %s: %s\n", FARFIELD_VERSION, ff_error_text(rc)); return rc != FF_ERR_ARGUMENT; }
    ff_client_update(client, 1000, &camera);
    ff_client_destroy(client);
    printf("Farfield %s: created\n", FARFIELD_VERSION);
    return 0;
}
END
# DESTDIR is not the final place: pkg-config puts it in front of the paths.
export PKG_CONFIG_PATH=$root/opt/ff/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$root
flags=$(pkg-config --cflags --libs farfield)
result $? "pkg-config knows farfield"
# shellcheck disable=SC2086
cc -std=c11 -Wall -Wextra -Werror "$work/stranger.c" $flags -o "$work/stranger" && LD_LIBRARY_PATH=$root/opt/ff/lib "$work/stranger" >"$work/said"
result $? "a stranger's program with the shared library"
version=$(sed -n 's/^#define FARFIELD_VERSION "\(.*\)"/\1/p' client/farfield.h)
grep -q "^Farfield $version: " "$work/said"; result $? "says the version"
[ "$(pkg-config --modversion farfield)" = "$version" ]; result $? "pkg-config says the same version"
# shellcheck disable=SC2046
cc -std=c11 "$work/stranger.c" $(pkg-config --cflags farfield) "$root/opt/ff/lib/libfarfield.a" \
    $(pkg-config --libs --static farfield | tr ' ' '\n' | grep -v '^-lfarfield$') -o "$work/stranger-static" &&
    "$work/stranger-static" >"$work/said-static" && cmp -s "$work/said" "$work/said-static"
result $? "the same with the static library"

make BUILD=build uninstall PREFIX=/opt/ff DESTDIR="$root" >"$work/make.log" 2>&1
[ -z "$(find "$root" -type f -o -type l)" ]; result $? "make uninstall leaves no file"
exit $((failures > 0))
