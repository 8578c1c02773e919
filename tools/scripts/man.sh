#!/bin/sh
# man.sh PROGRAM PAGE: a manual page from --help and --version. The one-line description is the first sentence of --help
# after the usage line.
set -eu
program=$1
page=$2
name=$(basename "$program")
about=$("$program" --help | awk 'BEGIN { RS = "" } NR == 2 { gsub("\n", " "); print }' | sed 's/\. .*//; s/[.:]$//')
help2man --no-info --name "$about" --output "$page.new" "$program"
mv "$page.new" "$page"
