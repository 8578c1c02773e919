#!/bin/bash
# The blank port answers every function that platform/sys.h declares, and the core links and runs over it.
set -u
cd "$(dirname "$0")/../.." || exit 2
build=${BUILD:-build}
. tests/rig/result.bash

"$build/null-check"
result $? "the core over the blank port"

sed -e 's|/\*.*\*/||' platform/sys.h | grep -oE '\bsys_[a-z0-9_]+\(' | tr -d '(' | sort -u >"$build/sys-declared"
nm --defined-only "$build"/obj/platform/{null/{sys_null,null_tcp,null_jpeg},random,events}.o | awk '$2 == "T" { print $3 }' | sort -u >"$build/sys-null"
missing=$(comm -23 "$build/sys-declared" "$build/sys-null" | tr '\n' ' ')
[ -n "$missing" ] && echo "# missing: $missing"
[ -s "$build/sys-declared" ] && [ -z "$missing" ]
result $? "every function of sys.h is in the blank port"
exit $((failures > 0))
