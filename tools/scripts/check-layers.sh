#!/bin/bash
# check-layers.sh [ROOT [OBJECTS]]: keeps the folders in their layers and the core pure. Prints each violation as
# "file:line: what"; exit 1 when there is one. OBJECTS (default ROOT/build/obj): objects of the normal build, for nm and objdump.
#
# Layers: who may include whom. Core: protocol, client, common3d compute in integers, take memory from the caller, and know no
# clock, chance, file or socket; common3d/gl* may use float to talk to GL; protocol/zlib/ff_deflate.c may let zlib allocate, and abort when it cannot.
set -u
root=${1:-$(dirname "$0")/../..}
cd "$root" || exit 2
objects=${2:-build/obj}
file_lines_max=600
function_lines_max=70
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
folders="protocol platform common3d client server tools sim tests"

# Code without comments, strings and character constants, as "file:line:code".
strip_code() {
    awk '
    FNR == 1 { comment = 0 }
    {
        line = $0; out = ""
        while (line != "") {
            if (comment) {
                end = index(line, "*/")
                if (!end) break
                line = substr(line, end + 2); comment = 0; continue
            }
            two = substr(line, 1, 2); one = substr(line, 1, 1)
            if (two == "//") break
            if (two == "/*") { comment = 1; line = substr(line, 3); continue }
            if (one == "\"" && out !~ /^[ \t]*#[ \t]*include/ || one == "\047") {
                for (i = 2; i <= length(line) && substr(line, i, 1) != one; i++)
                    if (substr(line, i, 1) == "\\") i++
                out = out one one; line = substr(line, i + 1); continue
            }
            out = out one; line = substr(line, 2)
        }
        print FILENAME ":" FNR ":" out
    }' "$@"
}

# ---- includes: who may include whom. A room has a row: what it may include besides its own files. `a/b/` is that room with all below it,
# `a/b` the files of that folder alone, `a/b.h` one header. Tests may include everything. ----
rooms() {
    cat <<'END'
protocol            protocol/codec protocol/shape
protocol/codec      protocol protocol/zlib
protocol/far        protocol protocol/trained
protocol/geo        protocol
protocol/message    protocol protocol/codec protocol/far
protocol/shape      protocol
protocol/zlib       protocol
protocol/trained    protocol protocol/codec
protocol/picture    protocol protocol/trained
platform            protocol/ff_error.h
platform/egl        platform
platform/glfw       platform
platform/memory     platform
platform/null       platform
platform/options    platform protocol/ff_error.h
platform/osmesa     platform
platform/posix      platform
platform/sim        platform
common3d            platform/sys.h protocol/ff_error.h
common3d/gl         common3d
common3d/gles1      common3d common3d/gl
common3d/soft       common3d
client/terrain      protocol protocol/codec protocol/shape common3d platform/sys.h
client/ahead        protocol common3d
client/ask          protocol/ platform/sys.h
client/source       client/ask protocol/ platform/sys.h
client/source/link  client/ask protocol/ platform/sys.h
client/images       client/ask client/terrain protocol/ common3d
client/map          protocol common3d
client/ground       client/farfield.h client/images client/map client/terrain protocol/ common3d
client/panorama     client client/ask client/ahead protocol/ common3d
client/far          client client/ask client/ahead client/ground client/terrain protocol/ common3d
client/balance      client
client/several      client client/terrain protocol/ platform/sys.h
client              client/ protocol/ common3d platform/sys.h
server/packs        protocol/ platform/sys.h
server/view         client/terrain protocol/ common3d
server/session      server/view server/packs protocol/ platform/sys.h
server/ground       client/terrain client/ground client/images protocol/ common3d platform/sys.h
server/panorama     server/ground client/terrain client/ground client/images protocol/ common3d platform/sys.h
server/far          server/ground client/terrain client/ground client/images protocol/ common3d platform/sys.h
server/net          server server/session server/panorama server/far protocol/ platform/sys.h
server              server/ platform/options client/farfield.h protocol/ platform/sys.h
sim/options         platform/options client/farfield.h protocol/shape
sim/link            platform/options server/session server/panorama server/far client/farfield.h protocol/ platform/sys.h
sim/judge           client/terrain client/images protocol/ common3d platform/sys.h
sim/tape            client/farfield.h protocol/ platform/sys.h
sim/fly             platform/options sim/options sim/link sim/judge sim/tape server/packs client/farfield.h client/ff_sky.h client/terrain client/ground client/images protocol/ common3d platform/sys.h
sim/view            platform/options sim/options sim/link server/packs client/farfield.h protocol/ common3d platform/sys.h
sim/handheld        platform/options sim/options sim/tape client/farfield.h protocol/ common3d platform/sys.h
tools/bake          platform/options tools/bake/ client/farfield.h protocol/ platform/sys.h
tools/bake/raster   tools/bake protocol/ platform/sys.h
tools/bake/image    tools/bake tools/bake/raster client/terrain/ff_shade.h protocol/ platform/sys.h
tools/bake/tiles    tools/bake tools/bake/raster platform/sys.h
tools/info          platform/options tools/bake tools/bake/raster client/farfield.h protocol/ platform/sys.h
tools/export        platform/options tools/bake tools/bake/raster tools/bake/tiles tools/info client/farfield.h protocol/ platform/sys.h
tools/merge         platform/options tools/bake tools/bake/raster tools/bake/image tools/info tools/export client/farfield.h protocol/ platform/sys.h
tools/train         platform/options tools/bake tools/info server/far client/farfield.h protocol/ platform/sys.h
tools/report        platform/options client/farfield.h common3d platform/sys.h
tools/scripts       protocol protocol/shape protocol/picture platform/sys.h
END
}

check_includes() {
    rooms >"$work/rooms"
    grep -E ':[ \t]*#[ \t]*include' "$work/code" | awk -F: -v rooms="$work/rooms" '
    BEGIN { while ((getline row < rooms) > 0) { split(row, word, " "); may[word[1]] = row " "; top[word[1]] = 1 } }
    function folder(path) { return sub(/\/[^\/]*$/, "", path) ? path : "" }
    function resolve(path,   part, n, i, kept, k, out) {
        n = split(path, part, "/"); k = 0
        for (i = 1; i <= n; i++)
            if (part[i] == "..") { if (k) k-- } else if (part[i] != "." && part[i] != "") kept[++k] = part[i]
        out = kept[1]; for (i = 2; i <= k; i++) out = out "/" kept[i]
        return out
    }
    function allowed(from, to,   room, i, n, word) {
        room = folder(to)
        if (room == from || from ~ /^tests(\/|$)/) return 1
        if (to == "protocol/ff_assert.h" && from ~ /^(protocol|client|common3d)(\/|$)/) return 1
        n = split(may[from], word, " ")
        for (i = 2; i <= n; i++)
            if (word[i] == room || word[i] == to || word[i] ~ /\/$/ && index(to, word[i]) == 1) return 1
        return 0
    }
    {
        file = $1; line = $2; text = $0
        sub(/^[^:]*:[^:]*:/, "", text)
        from = folder(file)
        if (!(from in may) && from !~ /^tests(\/|$)/ && !told[from]++) print file ":" line ": " from "/ has no row in check-layers.sh"
        if (match(text, /"[^"]+"/)) {
            name = substr(text, RSTART + 1, RLENGTH - 2)
            to = resolve(from "/" name)
            if (!allowed(from, to)) print file ":" line ": " from "/ may not include " to
        } else if (match(text, /<[^>]+>/)) {
            name = substr(text, RSTART + 1, RLENGTH - 2)
            core = from ~ /^(protocol|client|common3d)(\/|$)/
            glue = from ~ /^common3d\/gl/ && name ~ /^(GL|GLES)\//
            pure = "^(stddef|stdint|stdbool|limits|string|assert|inttypes)\\.h$"
            zlib = from == "protocol/zlib" && name == "zlib.h" || file == "protocol/zlib/ff_deflate.c" && name == "stdlib.h"
            if (core && name !~ pure && !glue && !zlib)
                print file ":" line ": <" name "> in the core"
            else if (from ~ /^sim(\/|$)/ && name ~ /^(unistd|pthread|poll|netdb|dlfcn|sched|fcntl|dirent)\.h$|^(sys|netinet|arpa|GLFW|EGL)\/|osmesa/)
                print file ":" line ": <" name "> belongs to platform/"
        }
    }'
}

# ---- words that have no place in the core ----
report_words() { # PATTERN WHAT, lines of code on stdin
    grep -E "$1" | sed -E "s/^([^:]*:[^:]*):.*/\\1: $2/"
}

check_words() {
    local core="$work/core"
    grep -E '^(protocol|client|common3d)/' "$work/code" >"$core"
    grep -v '^common3d/gl' "$core" | report_words ':(.*[^A-Za-z0-9_])?(float|double)([^A-Za-z0-9_]|$)' 'floating point in the core'
    report_words '[^A-Za-z0-9_.>](malloc|calloc|realloc|free|strdup|alloca|posix_memalign) *\(' 'allocation in the core' <"$core"
    report_words '[^A-Za-z0-9_.>]((f|s|sn|v|vf|vs|vsn|d)?printf|puts|putchar|fputs|fopen|fread|fwrite|perror|getenv) *\(' \
        'input or output in the core' <"$core"
    grep -v '^protocol/zlib/ff_deflate.c:' "$core" | report_words '[^A-Za-z0-9_.>](exit|abort) *\(' 'an end of the process in the core'
    grep -v '^protocol/ff_assert.h:' "$core" | report_words '[^A-Za-z0-9_.>]assert *\(' 'assert instead of FF_ASSERT or C3D_ASSERT in the core'
    report_words '[^A-Za-z0-9_.>](time|clock|clock_gettime|gettimeofday|nanosleep|usleep|rand|rand_r|srand|random|drand48) *\(' \
        'clock or chance in the core' <"$core"
    grep '^tests/' "$work/code" | report_words 'cmocka_unit_test[a-z_]*\(test_' 'a test is named by a sentence'
}

# ---- the ground's shape: who counts tiles, multiplies edges, takes sides for opposite, or reads what a shape keeps, asks protocol/shape ----
shape_words() { # PATTERN that no code may have but protocol/shape, the tests, and the files named; each with its reason
    cat <<'END'
(^|[^A-Za-z0-9_])(tiles|samples)_[xy]([^A-Za-z0-9_]|$)
    protocol/ff_terrain.h      declares them
    protocol/ff_terrain.c      compares two terrains
    protocol/ff_bytes.c        reads and writes them, in packs and messages
    sim/judge/sim_ground.c     compares two terrains
    tools/bake/bake_fault.c    says which field is out of range
(^|[^A-Za-z0-9_])spacing_wu([^A-Za-z0-9_]|$)
    protocol/ff_terrain.h      declares it; an edge and a cell are so many spacings
    protocol/ff_terrain.c      compares two terrains
    protocol/ff_bytes.c        reads and writes it
    sim/judge/sim_ground.c     compares two terrains
    client/ground/ff_ground_frame.c  a vertex is placed in units of a sample
    client/terrain/ff_cover.c  the finer of two grounds
    tools/bake/bake_run.c      describes the raster; reports it
    tools/bake/bake_estimate.c  the same, beforehand
    tools/bake/bake_fault.c    says which field is out of range
    tools/bake/raster/bake_lattice.c  chooses spacings that go with it
    tools/export/export_place.c  writes it into a raster's head
    tools/info/bake_info.c     reports it
    tools/merge/merge_lattice.c  compares the packs', and describes the joint one
    tools/merge/merge_run.c    tells it
ff_node_(edge|cell)_wu
    protocol/ff_terrain.h      defines them: nominal lengths
    protocol/ff_entry.c        how many tiles a view reaches into, at most
    client/terrain/ff_measure.c  the e of f = d / (e C)
    client/terrain/ff_wish.c   the same, of roots
    client/terrain/ff_surface.c  a place in a node's grid
    client/terrain/ff_seam_dive.c  how far the edges of a mesh reach from a vertex
    client/terrain/ff_seam_rim.c  the same
    client/terrain/ff_cover.c  how far grounds over each other keep from each other's rims, and the steps between tiles
    client/terrain/ff_select.c  hands a node's cell to who draws it
    client/images/ff_textures.c  the e of images
    client/images/ff_wear.c    the edge of a texel
    client/client_update.c     how far beyond its middle a node reaches, at most
    sim/judge/sim_ground.c     the judge's own side of the plane, with sim_place.c
    tools/bake/image/bake_own.c  the slope between samples
    sim/judge/sim_watertight.c  compares it with what is drawn
drawn(\[[^]]*\])?(\.|->)origin_wu
    client/terrain/ff_select.c  asks the shape for it
    client/ground/ff_terrain_view.c  the hash of the geometry
    client/ground/ff_ground_frame.c  a vertex is placed in units of a sample
    sim/judge/sim_place.c      the judge's own side of the plane
    sim/judge/sim_watertight.c  compares it with the shape's
\(side *\+ *2\)|% *FF_SIDE_COUNT|ff_side_opposite
ff_planar_|(\.|->)planar([^A-Za-z0-9_]|$)
END
}

check_shape() {
    shape_words >"$work/shape"
    grep -vE '^(protocol/shape|tests)/' "$work/code" | awk -v rows="$work/shape" '
    BEGIN {
        while ((getline row < rows) > 0)
            if (row ~ /^ /) { split(row, word, " "); may[word[1], count] = 1; named[word[1], count] = 1 } else pattern[++count] = row
    }
    {
        split($0, part, ":"); file = part[1]; text = $0
        sub(/^[^:]*:[^:]*:/, "", text)
        seen[file] = 1
        for (i = 1; i <= count; i++) {
            if (text !~ pattern[i]) continue
            if ((file, i) in may) { delete named[file, i]; continue }
            match(text, pattern[i])
            what = substr(text, RSTART, RLENGTH)
            gsub(/^[^A-Za-z0-9_%]+|[^A-Za-z0-9_]+$/, "", what)
            print file ":" part[2] ": " what ": ask protocol/shape"
        }
    }
    END {
        for (pair in named) {
            split(pair, word, SUBSEP)
            if (word[1] in seen) print word[1] ":1: has no " pattern[word[2]] ": take it out of shape_words in check-layers.sh"
        }
    }'
}

# ---- size of files and functions, left-over notes, file names ----
check_sizes() {
    wc -l $(cat "$work/files") | awk -v max="$file_lines_max" '$2 != "total" && $1 > max {
        print $2 ":" $1 ": file longer than " max " lines" }'
    awk -F: -v max="$function_lines_max" '
    {
        file = $1; line = $2 + 0; text = $0
        sub(/^[^:]*:[^:]*:/, "", text)
        if (file != last_file) { depth = 0; last_file = file; tail = "" }
        if (text ~ /^[ \t]*#/) next
        n = length(text)
        for (i = 1; i <= n; i++) {
            c = substr(text, i, 1)
            if (c == "{") { if (depth == 0) { start = line; is_function = tail == ")" } depth++ }
            else if (c == "}") {
                depth--
                if (depth == 0 && is_function && line - start + 1 > max)
                    print file ":" start ": function of " line - start + 1 " lines, more than " max
            }
            if (c != " " && c != "\t") tail = c
        }
    }' "$work/code"
}

check_notes_and_names() {
    grep -n -E '\b(TO''DO|FIX''ME|HA''CK|XX''X)\b' $(cat "$work/files") Makefile ./*.mk tools/scripts/*.sh tests/*.sh tests/*/*.sh /dev/null 2>/dev/null |
        sed -E 's/^([^:]*:[^:]*):.*/\1: note of unfinished work/'
    sed 's|.*/||' "$work/files" | sort | uniq -d | while read -r name; do
        echo "$(grep "/$name\$" "$work/files" | tr '\n' ' '): file name used twice"
    done
}

# ---- each source is named in the README of its folder or of the one above, and READMEs of rooms name nothing that is gone ----
check_readmes() {
    local file folder stem page line name
    grep -v '^tests/[^/]*$' "$work/files" | while read -r file; do
        folder=${file%/*} stem=${file##*/}
        stem=${stem%.*}
        cat "$folder/README.md" "${folder%/*}/README.md" 2>/dev/null | grep -q -F "$stem" || echo "$file:1: named in no README"
    done
    find $folders -name README.md 2>/dev/null | while read -r page; do
        grep -noE '^- `[a-z0-9_]+\.[a-z.]+`' "$page" | tr -d '`' | sed 's/:- /:/' | while IFS=: read -r line name; do
            [ -e "${page%/*}/$name" ] || echo "$page:$line: names $name, which is not there"
        done
    done
}

# ---- what the compiled core really calls ----
core_objects() {
    find "$objects"/protocol "$objects"/client "$objects"/common3d -name '*.o' -not -path '*/gl*/*' 2>/dev/null | sort | while read -r object; do
        # Objects of sources that are gone do not count.
        source=${object#"$objects/"}
        if [ -e "${source%.o}.c" ]; then echo "$object"; fi
    done
}

check_objects() {
    local list
    list=$(core_objects)
    if [ -z "$list" ]; then echo "$objects:0: no objects of the core (build first)"; return; fi
    nm -A --defined-only $list "$objects"/common3d/gl*/*.o 2>/dev/null | awk '{ print $NF }' | sort -u >"$work/defined"
    nm -A -u $list | awk -v defined="$work/defined" '
    BEGIN {
        while ((getline name < defined) > 0) own[name] = 1
        pure = "^(mem(cpy|move|set|cmp|chr)|str(len|cmp|ncmp|chr)|__assert_fail|inflate[A-Za-z0-9_]*|crc32|sys_.*|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail)$"
    }
    {
        name = $NF; object = $1; sub(/:.*/, "", object)
        if (own[name] || name ~ pure || name ~ /^(deflate.*|abort)$/ && object ~ /ff_deflate\.o$/) next
        print object ":0: calls " name
    }'
    for object in $list; do
        objdump -d --no-show-raw-insn "$object" |
            grep -m 1 -E '\b(v?cvtt?s[is]2s|v?(add|sub|mul|div|sqrt)[sp][sd]|fild|fldl|fadd|fmul)\b' >/dev/null &&
            echo "$object:0: floating-point instructions"
    done
}

for folder in $folders; do [ -d "$folder" ] && find "$folder" -name '*.[ch]'; done | sort >"$work/files"
# shellcheck disable=SC2046
strip_code $(cat "$work/files") >"$work/code"
{
    check_includes
    check_words
    check_shape
    check_sizes
    check_notes_and_names
    check_readmes
    check_objects
} >"$work/violations"
cat "$work/violations"
[ ! -s "$work/violations" ]
