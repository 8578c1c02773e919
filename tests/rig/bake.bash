# What script tests of single bakes share, read with `. tests/rig/bake.bash` behind result.bash; BIN names the programs. Each bake leaves
# OUT.ffp, its summary in bake.json and what it said in bake.err.
bake() { timeout 30 "$BIN/farfield-bake" "$@" -o OUT.ffp --json >bake.json 2>bake.err; }
field() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" bake.json; } # NAME: a number or word of the last bake's summary
noted() { grep -q "$1" bake.err || { sed 's/^/#   /' bake.err; return 1; }; }
refused() { # PATTERN BAKE-ARGUMENTS...: at once, in one line, and nothing is left
    local pattern=$1
    shift
    rm -f OUT.ffp
    bake "$@"
    [ $? = 1 ] && [ "$(wc -l <bake.err)" = 1 ] && noted "$pattern" && [ ! -e OUT.ffp ]
}

# Writes bare.asc, heights of 500 + 3 x - 2 y in 60 x 48 samples, and bare.ppm, an image of as many whose red grows to the right, green
# downwards.
bare_rasters() {
    python3 - <<'PY'
with open('bare.asc', 'w') as out:
    out.write('ncols 60\nnrows 48\nxllcorner 0\nyllcorner 0\ncellsize 1\n')
    for y in range(48):
        out.write(' '.join(str(500 + 3 * x - 2 * y) for x in range(60)) + '\n')
with open('bare.ppm', 'wb') as out:
    out.write(b'P6\n60 48\n255\n' + b''.join(bytes((4 * x, 5 * y, 40)) for y in range(48) for x in range(60)))
PY
}
