#!/bin/bash
# The tree keeps its layers, its core pure and its files small (tools/scripts/check-layers.sh); and that check sees what it should see.
# Lists that stand beside a list are held to it.
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/rig/result.bash

tools/scripts/check-layers.sh . build/obj
result $? "layers, core words, sizes and symbols"

git ls-files '*.[ch]' | xargs clang-format --dry-run --Werror >/dev/null 2>&1
result $? "all C is laid out by .clang-format (make format)"

# What the documents link to is there.
missing=$(git ls-files '*.md' 2>/dev/null | while read -r page; do
    grep -o '](\([^)#]*\))' "$page" | sed 's/^](//; s/)$//' | grep -v '^[a-z]*:' | while read -r target; do
        [ -e "$(dirname "$page")/$target" ] || echo "$page: $target"
    done
done)
[ -z "$missing" ]
result $? "links in documents lead somewhere $missing"

# Every public report of tests/REPORTS.md names a test that is there.
reports() { # FILE: the rows whose test is not found, or whose report stands twice
    awk -F' \\| ' '/^\| [^ ]*#[0-9]+ \|/ { print $1 "|" $3 }' "$1" | sed 's/^| //; s/ |$//' | while IFS='|' read -r report test; do
        [ "$test" = PROPERTIES ] && test=$(sed -n 's/.*PROPERTIES stands for \(`.*\)\.$/\1/p' "$1" | tr -d '`') || test=${test//\`/}
        file=$(git ls-files "tests/*/${test%%: *}")
        [ -n "$file" ] && [ -n "$test" ] && grep -qF -- "${test#*: }" "$file" || echo "$report: ${test:-no test}"
    done
    sed -n 's/^| \([^ ]*#[0-9]*\) .*/\1/p' "$1" | sort | uniq -d
}
rows=$(grep -c '^| [^ ]*#[0-9]* |' tests/REPORTS.md)
missing=$(reports tests/REPORTS.md)
[ -z "$missing" ] && [ "$rows" -ge 40 ]
result $? "the tests that tests/REPORTS.md names are there, for $rows reports $missing"
mkdir -p build/tests
sed '0,/PROPERTIES |/s//`bake_place.sh`: pigs fly |/' tests/REPORTS.md >build/tests/reports.md
[ "$(reports build/tests/reports.md | grep -c 'pigs fly')" = 1 ]
result $? "and one that is not there is found"

# ---- features that can be left out: features.mk has the list ----
features=$(make -s features)
told=$(sed -n 's/.*`make handheld NO="\([^"]*\)"`.*/\1/p' README.md)
[ -n "$features" ] && [ "$(tr ' ' '\n' <<<"$features" | sort)" = "$(tr ' ' '\n' <<<"$told" | sort)" ]
result $? "README.md names the features of features.mk ($features)"

# ---- rows that objects count to, in the instruction bench and in the sizes ----
rows=tools/scripts/handheld_rows.py
objects=$(make -s handheld-objects)
wrong=$($rows <<<"$objects" 2>&1)
result $? "every object of the handheld has a row, every row an object $wrong"
$rows <<<"$objects"$'\n'client/cellar/dig.o 2>&1 | grep -q '^no row for client/cellar/dig.o: add it to PLACES '
result $? "an object of a new room is refused"
$rows <<<"$objects"$'\n'client/terrain/dig.o 2>&1 | grep -q '^no row for client/terrain/dig.o: add it to PLACES '
result $? "and a new one in a room whose objects count to several rows"
$rows < <(grep -v ff_wish.o <<<"$objects") 2>&1 | grep -q '^there is no client/terrain/ff_wish.o: take it out of PLACES '
result $? "and a row for an object that is gone"
mkdir -p build/tests
cat >build/tests/rows.py <<'END'
import sys
sys.path.insert(0, "tools/scripts")
import handheld_rows, stack_handheld
try:
    handheld_rows.phase_of("draw", "client/ask/ff_request.o")
    sys.exit("a request under the mark draw found a row")
except handheld_rows.NoRow:
    pass
stack_handheld.THROUGH_POINTERS = [("^c3d_open$", "a"), ("^c3d_(open|shut)$", "b"), ("^c3d_close$", "c")]
unused = stack_handheld.rows_unused({"c3d_open", "c3d_close"})
sys.exit(unused != ["^c3d_(open|shut)$"] and "unused: %s" % unused)
END
wrong=$(python3 build/tests/rows.py 2>&1)
result $? "so are work where none was expected, and calls through pointers that nobody makes $wrong"

# A copy of a tiny tree with one violation of every kind: each must be named.
planted=build/tests/checks
rm -rf "$planted"
mkdir -p "$planted"/{protocol,client/{terrain,ask,cellar},common3d/gl,platform,server/session,tools/bake,sim/{judge,link,fly},tests,build/obj/protocol}

plant() { cat >"$planted/$1"; }
plant protocol/clean.c <<'END'
#include <string.h>
/* float malloc(1) time(0): words in comments and "strings" do not count */
const char *clean_text = "double printf(";
END
echo '- `clean.c`' >"$planted/protocol/README.md"
cc -std=c99 -c "$planted/protocol/clean.c" -o "$planted/build/obj/protocol/clean.o"
tools/scripts/check-layers.sh "$planted" >"$planted/found" 2>&1
result $? "a clean tree passes"

plant protocol/upward.c <<'END'
#include "../platform/sys.h"
#include <stdio.h>
END
plant client/words.c <<'END'
#include "../server/session/ff_session.h"
static float half(void) { return 0; }
static void *take(void) { return malloc(1); }
static void say(void) { printf("x"); }
static long now(void) { return time(0); }
END
plant server/session/reach.c <<'END'
#include "../../client/source/link/ff_stream.h"
#include "../../protocol/message/ff_message.h"
END
plant client/ask/climb.c <<'END'
#include "../ff_client_local.h"
#include "../../protocol/ff_key.h"
END
echo '- `glue.c`' >"$planted/common3d/gl/README.md"
plant client/README.md <<'END'
- `words.c`: is there
- `ghost.c`: is not
END
plant client/cellar/dig.c <<'END'
#include "../terrain/ff_tree.h"
END
plant sim/judge/partial.c <<'END'
#include "../link/sim_link.h"
#include "../fly/fly_options.h"
#include "../../client/terrain/ff_tree.h"
END
plant sim/link/os.c <<'END'
#include <unistd.h>
#include "../../tests/helper.h"
END
plant client/terrain/ff_foresee.c <<'END'
#include "../../protocol/ff_terrain.h"
unsigned tile_above(const ff_terrain_info *info, unsigned tile) { return tile + info->tiles_x; }
int wide(const ff_terrain_info *info) { return 2 * ff_node_edge_wu(info, 0); }
int across(int side) { return (side + 2) % 4; }
int corner(const ff_drawn *drawn) { return drawn->origin_wu[0]; }
int kept(const ff_placed *placed) { return placed->planar.x_wu; }
int fine(const c3d_draw *draw) { return draw->origin_wu[0]; }
END
plant sim/judge/sim_watertight.c <<'END'
int fine(const ff_drawn *drawn) { return drawn->origin_wu[0]; }
END
plant common3d/gl/glue.c <<'END'
#include <GL/gl.h>
static float fine(void) { return 0; }
END
{ echo "int long_function(void)"; echo "{"; seq -f "    /* %g */" 80; echo "}"; } | plant tools/bake/long.c
seq -f "/* %g */" 601 | plant sim/fly/big.c
echo "/* TO""DO */" | plant platform/note.c
plant tools/bake/clean.c </dev/null
plant tests/test_words.c <<'END'
const int list[] = { cmocka_unit_test(ground_has_no_holes),
                     cmocka_unit_test(test_ground) };
END
plant protocol/calls.c <<'END'
extern void *malloc(unsigned long);
extern int gettimeofday(void *, void *);
double calls(double x);
double calls(double x) { gettimeofday(malloc(1), 0); return x * 1.5; }
END
cc -std=c99 -fno-builtin -c "$planted/protocol/calls.c" -o "$planted/build/obj/protocol/calls.o"
tools/scripts/check-layers.sh "$planted" >"$planted/found" 2>&1
result $((! $?)) "a tree with violations fails"

expect() { # WHAT LINE
    grep -q -F -x "$2" "$planted/found"
    result $? "finds $1"
}
expect "an include of a higher layer" "protocol/upward.c:1: protocol/ may not include platform/sys.h"
expect "stdio in the core" "protocol/upward.c:2: <stdio.h> in the core"
expect "the client including the server" "client/words.c:1: client/ may not include server/session/ff_session.h"
expect "floating point" "client/words.c:2: floating point in the core"
expect "allocation" "client/words.c:3: allocation in the core"
expect "output" "client/words.c:4: input or output in the core"
expect "a clock" "client/words.c:5: clock or chance in the core"
expect "the server reaching into the client" "server/session/reach.c:1: server/session/ may not include client/source/link/ff_stream.h"
expect "a room of the client that climbs" "client/ask/climb.c:1: client/ask/ may not include client/ff_client_local.h"
expect "a room that nobody knows" "client/cellar/dig.c:1: client/cellar/ has no row in check-layers.sh"
expect "a file that no README names" "client/cellar/dig.c:1: named in no README"
expect "a file that only a README knows" "client/README.md:2: names ghost.c, which is not there"
expect "a judge that knows the link" "sim/judge/partial.c:1: sim/judge/ may not include sim/link/sim_link.h"
expect "a judge that knows the flight" "sim/judge/partial.c:2: sim/judge/ may not include sim/fly/fly_options.h"
expect "an OS header outside platform" "sim/link/os.c:1: <unistd.h> belongs to platform/"
expect "an include of tests" "sim/link/os.c:2: sim/link/ may not include tests/helper.h"
expect "a test without a sentence" "tests/test_words.c:2: a test is named by a sentence"
expect "tiles counted by hand" "client/terrain/ff_foresee.c:2: tiles_x: ask protocol/shape"
expect "an edge multiplied" "client/terrain/ff_foresee.c:3: ff_node_edge_wu: ask protocol/shape"
expect "sides taken for opposite" "client/terrain/ff_foresee.c:4: side + 2: ask protocol/shape"
expect "a place read by hand" "client/terrain/ff_foresee.c:5: drawn->origin_wu: ask protocol/shape"
expect "what a shape keeps, read elsewhere" "client/terrain/ff_foresee.c:6: planar: ask protocol/shape"
expect "a file that no longer needs its leave" \
    "sim/judge/sim_watertight.c:1: has no ff_node_(edge|cell)_wu: take it out of shape_words in check-layers.sh"
expect "a long function" "tools/bake/long.c:2: function of 82 lines, more than 70"
expect "a long file" "sim/fly/big.c:601: file longer than 600 lines"
expect "a left-over note" "platform/note.c:1: note of unfinished work"
expect "a file name used twice" "protocol/clean.c tools/bake/clean.c : file name used twice"
expect "a call to malloc" "build/obj/protocol/calls.o:0: calls malloc"
expect "a call to the clock" "build/obj/protocol/calls.o:0: calls gettimeofday"
expect "floating-point instructions" "build/obj/protocol/calls.o:0: floating-point instructions"
if grep -q -e glue.c -e 'foresee.c:7' -e 'watertight.c:.*origin' -e 'reach.c:2' -e 'climb.c:2' -e 'partial.c:3' "$planted/found"; then result 1 "no false alarms"; else result 0 "no false alarms"; fi
exit $((failures > 0))
