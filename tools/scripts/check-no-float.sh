#!/bin/bash
# check-no-float.sh PREFIX OBJECT...: fails when a cross-compiled object (PREFIX as of its nm and objdump) has a floating-point
# instruction or refers to a soft-float helper. Counts the references to 64-bit division helpers, which are allowed.
set -u
prefix=$1
shift
helpers='__aeabi_([fd][a-z0-9_]*|[ui]?l?2[fd]|h2f|[fd]2[a-z0-9]+|c[fd]cmp[a-z]*)|__(add|sub|mul|div|neg|cmp|eq|ne|lt|le|gt|ge|unord)[sd]f[23]?|__(fix|fixuns|float|floatun|extend|trunc)[a-z]*f[a-z0-9]*'
bad=$("$prefix"nm -A -u "$@" | grep -E " U ($helpers)$")
fpu=$("$prefix"objdump -d --no-show-raw-insn "$@" 2>/dev/null | awk -F'\t' '
    /file format/ { file = $1; sub(/:.*/, "", file) }
    NF > 1 && $2 ~ /^(v[a-z]|f(ld|st|add|sub|mul|div|cmp|cvt|to|si|ui|mac|nmac|msc|neg|abs|sqrt|mr|ms|cp)[a-z0-9]*[sd]|ld[cf]|st[cf]|mcr[^r]*p1[01])/ { print file ": " $2 " " $3 }')
divisions=$("$prefix"nm -A -u "$@" | grep -c -E ' U __aeabi_u?ldivmod$')
[ -z "$bad" ] || echo "$bad" | head -5
[ -z "$fpu" ] || echo "$fpu" | head -5
echo "$# objects; $divisions refer to 64-bit division"
[ -z "$bad$fpu" ]
