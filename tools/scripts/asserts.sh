#!/bin/bash
# asserts.sh [ROOT]: functions and assertions of the core, by folder, as a table; exit 1 when the core has fewer than one assertion in two
# functions, or when more than half of them only say that something is set. A function is counted by its opening brace, as .clang-format
# sets it; assertions are FF_ASSERT, C3D_ASSERT and FF_STATIC_ASSERT.
# `pointers`: those that only say that something is set, of the form "name", "name->name" or with "!= NULL".
set -u
cd "${1:-$(dirname "$0")/../..}" || exit 2
find protocol client common3d -name '*.[ch]' | sort | xargs awk '
function ratio(a, b) { return b ? sprintf("%.2f", a / b) : "-" }
function row(name, f, a, s, p) { printf "%-24s %9d %10d %9d %9d %9s\n", name, f, a, s, p, ratio(a, f) }
BEGIN { printf "%-24s %9s %10s %9s %9s %9s\n", "folder", "functions", "assertions", "static", "pointers", "each" }
FNR == 1 { folder = FILENAME; sub(/\/[^\/]*$/, "", folder); if (!(folder in functions)) { order[++folders] = folder; functions[folder] = 0 } }
/^\{$/ || /^[a-z].*\) \{.*\}$/ { functions[folder]++ }
/^#/ { next }
/(^|[^A-Z_])(FF|C3D)_ASSERT\(/ {
    asserts[folder]++
    if (/ASSERT\([a-z_0-9.>-]+( != NULL)?\);/) pointers[folder]++
}
/(^|[^A-Z_])FF_STATIC_ASSERT\(/ { asserts[folder]++; static[folder]++ }
END {
    for (i = 1; i <= folders; i++) {
        name = order[i]
        row(name, functions[name], asserts[name], static[name], pointers[name])
        f += functions[name]; a += asserts[name]; s += static[name]; p += pointers[name]
    }
    row("core", f, a, s, p)
    exit 2 * a < f || 2 * p > a
}'
