#!/bin/bash
# What is known is asserted: enough assertions in the core, and broken bounds stop at one (bounds.py says which).
cd "$(dirname "$0")/../.." || exit 2
. tests/rig/result.bash
table=$(tools/scripts/asserts.sh)
result $? "the core has an assertion in every other function: $(tail -1 <<<"$table")"
few=build/tests/few_asserts
rm -rf "$few" && mkdir -p "$few"/{protocol,client,common3d}
printf 'int none(void)\n{\n    return 1;\n}\nint some(void)\n{\n    FF_ASSERT(1 < 2);\n}\n' >"$few/protocol/two.c"
tools/scripts/asserts.sh "$few" >/dev/null
result $? "a tree with one in two functions passes"
cp "$few/protocol/two.c" "$few/client/more.c"
sed -i '/ASSERT/d' "$few/client/more.c"
! tools/scripts/asserts.sh "$few" >/dev/null
result $? "one with fewer does not"
sed -i 's/1 < 2/bytes != NULL/; s/return 1/FF_ASSERT(place)/' "$few/protocol/two.c"
! tools/scripts/asserts.sh "$few" >/dev/null
result $? "nor does one whose assertions only say that something is set"
python3 tests/project/bounds.py || failures=1
exit $((failures > 0))
