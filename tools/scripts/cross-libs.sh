#!/bin/bash
# cross-libs.sh DEST ARCH[,ARCH...] PACKAGE...: unpacks Debian packages of other architectures into DEST/ARCH, and sources ("src:NAME")
# into DEST/src. apt keeps lists and cache of its own under DEST/apt: the machine's own packages and architectures stay as they are,
# and root is not needed. Prints what it fetches.
set -eu
dest=$1 archs=${2//,/ }
shift 2
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
mkdir -p "$dest"/apt/lists/partial "$dest"/apt/cache/archives/partial "$dest"/debs
cd "$dest"
: >apt/status
printf 'deb [signed-by=%s] %s bookworm main\ndeb-src [signed-by=%s] %s bookworm main\n' \
    "$keyring" "$mirror" "$keyring" "$mirror" >apt/sources.list
options=(-qq -o Dir::State="$PWD/apt" -o Dir::State::Lists="$PWD/apt/lists" -o Dir::State::Status="$PWD/apt/status"
    -o Dir::Cache="$PWD/apt/cache" -o Dir::Etc::sourcelist="$PWD/apt/sources.list" -o Dir::Etc::sourceparts=-
    -o APT::Architecture="${archs%% *}" -o Acquire::Languages=none -o Acquire::IndexTargets::deb::DEP-11::DefaultEnabled=false)
[ "$(id -u)" != 0 ] || options+=(-o APT::Sandbox::User=root)
for arch in $archs; do options+=(-o APT::Architectures::="$arch"); done

echo "farfield: fetching from Debian into $dest for $archs: $*" >&2
apt-get "${options[@]}" update
rm -f debs/*
for package in "$@"; do
    case $package in
        src:*) (mkdir -p src && cd src && apt-get "${options[@]}" --download-only source "${package#src:}") ;;
        *) for arch in $archs; do (cd debs && apt-get "${options[@]}" download "$package:$arch"); done ;;
    esac
done
for deb in debs/*.deb; do
    arch=${deb##*_}
    dpkg-deb -x "$deb" "${arch%.deb}"
done
for source in src/*.dsc; do
    [ -e "$source" ] || continue
    name=${source##*/} name=${name%%_*}
    rm -rf "src/$name"
    mkdir -p "src/$name"
    tar -xf src/"$name"_*.orig.tar.* -C "src/$name" --strip-components=1
done
