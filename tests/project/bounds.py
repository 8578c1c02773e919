#!/usr/bin/env python3
"""bounds.py: breaks bounds of the core one at a time, in a copy of the tree, and tells how many of them stop at an assertion: a loop one step
longer, a limit one too high, a clamp left out. At least MUST_STOP of them do, in an ordinary flight or unit test; whatever goes by
unnoticed or is found by something else is named. Prints TAP lines."""
import os
import re
import shutil
import sys

from tree_copy import copy_tree, run

WORK = "build/tests/bounds"
MUST_STOP = 16
FLIGHT = ("build/bin/farfield-fly --pack ../%s.ffp --link umts --path diagonal --speed 600 --seconds 4 --settle 4 --fps 10 --backend soft "
          "--quality px:1 --memory 1M --json")

# file, the text as it stands (once in the file), what replaces it, what that breaks, and what runs into it: a test, or a flight over ground
# of a codec
BREAKS = [
    ("protocol/codec/ff_body.c", "for (; held < width; held += 8)", "for (; held <= width; held += 8)", "take_low takes no byte that its values do not reach", "deflate"),
    ("protocol/codec/ff_codec_deflate.c", "return ff_align_up(ff_refinement_count(info));", "return ff_align_up(ff_node_side(info));", "decoder memory has room for all high parts of a payload", "deflate"),
    ("protocol/codec/ff_predict.c", "uint32_t cells = (side - 1) / (2 * stride), row", "uint32_t cells = side / stride, row", "a doubling has half as many cells as its grid has steps", "deflate"),
    ("protocol/trained/ff_range.h", "while (range->width < FF_RANGE_LEAST) {", "while (range->width < FF_RANGE_LEAST / 256) {", "a range is not left small", ""),
    ("protocol/message/ff_message.c", "return FF_MESSAGE_HEADER_MAX + 1 + 2 + FF_TERRAIN_SET + FF_TERRAIN_BYTES +", "return FF_TERRAIN_SET +", "room that ff_message_bytes_max asks for WELCOME", ""),
    ("protocol/message/ff_message.c", "return FF_MESSAGE_HEADER_MAX + (size_t)message->u.data.byte_count;", "return (size_t)message->u.data.byte_count;", "room that ff_message_bytes_max asks for an answer", ""),
    ("protocol/message/ff_face_columns.c", "length < 272", "length < 280", "a long run is 272 values at most", "test_face_columns"),
    ("protocol/shape/ff_shape_planar.c", "case FF_SIDE_NORTH: *tile += info->tiles_x; return y + 1 < info->tiles_y;", "case FF_SIDE_NORTH: *tile += info->tiles_x; return y < info->tiles_y;", "the terrain ends north of its last row of tiles", ""),
    ("protocol/shape/ff_shape_planar.c", "walk->planar.left = (uint32_t)(to - from) + 1;", "walk->planar.left = (uint32_t)(to - from) + 2;", "a run of tiles ends within the tiles in reach", ""),
    ("protocol/shape/ff_shape_planar.c", "(int32_t)ff_morton_x(code) * edge_wu", "(int32_t)ff_morton_x(code) * (edge_wu + 1)", "nodes lie at multiples of their edge", ""),
    ("client/terrain/ff_pool.c", "tree->free_head = node->hash_next;", "tree->free_head = slot;", "a slot given twice", ""),
    ("client/terrain/ff_strips.c", "while (outer < n || inner < n - 1) {", "while (outer < n || inner < n) {", "triangles of a side", ""),
    ("client/terrain/ff_sort.c", "if (child >= count) break;", "if (child > count) break;", "a heap beyond its end", ""),
    ("client/terrain/ff_view_cull.c", "while (largest >> bits >> PLANE_BITS) bits++;", "while (largest >> bits >> PLANE_BITS >> 1) bits++;", "normals of 28 bits", ""),
    ("client/terrain/ff_tree.c", "from->used += (bytes + BLOCK_ALIGN - 1) & ~(size_t)(BLOCK_ALIGN - 1);", "from->used += bytes;", "alignment of parts of the block", ""),
    ("client/terrain/ff_evict.c", "while (tree->free_count < needed) {", "while (tree->free_count + 1 < needed) {", "room for four children", "test_tree_pools"),
    ("client/terrain/ff_surface.c", "unsigned side = ff_node_side(info), last = side - 2,", "unsigned side = ff_node_side(info), last = side - 1,", "the last cell of a row", "test_tree_view"),
    ("client/ground/ff_terrain_view.c", "*user = place + 1;", "*user = place + 2;", "the entry that a node names", ""),
    ("client/ground/ff_ground_frame.c", "(place_wu[axis] - first.lo[axis]) % spacing);", "(place_wu[axis] - first.lo[axis]) % (spacing + 1));", "the frame on a sample", ""),
    ("client/panorama/ff_panorama_join.c", "for (int i = 0; i <= PATCHES; i++) {", "for (int i = 0; i <= PATCHES + 1; i++) {", "patches of a face", ""),
    ("client/ask/ff_request.c", "counts->in_flight--;", "counts->in_flight -= 2;", "requests in flight are counted one by one", ""),
]


def what_stops(where, name, old, new, runs):
    """The assertion at which the broken tree stops, or what else came of it."""
    path = os.path.join(where, name)
    source = open(path).read()
    if source.count(old) != 1:
        return 0, "%s has %r %d times" % (name, old, source.count(old))
    open(path, "w").write(source.replace(old, new))
    test = "build/tests/" + runs if runs.startswith("test_") else ""
    built = run("make -j2 BUILD=build %s" % (test or "build/bin/farfield-fly"), where)
    done = run(test or FLIGHT % (runs or "trained"), where) if built.returncode == 0 else built
    open(path, "w").write(source)
    stopped = re.search(r"^.*?([a-z0-9_]+\.[ch]:\d+): .*Assertion `(.*)' failed", done.stdout, re.M)
    if stopped:
        return 1, "%s: %s" % stopped.groups()
    if built.returncode and "ff_static_assert_holds" in built.stdout:
        return 1, "does not build: a static assertion"
    return 0, "does not build" if built.returncode else "ends with %d" % done.returncode


def main():
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
    os.makedirs(WORK, exist_ok=True)
    where, stopped = WORK + "/tree", 0
    bake = "build/bin/farfield-bake %s/hills.raw --raw 129x129 --spacing 40 --tile-log2 5 --quiet" % WORK
    baked = run("python3 tests/rig/hills.py 129 %s/hills.raw" % WORK + "".join(
        " && %s --codec %s -o %s/%s.ffp" % (bake, codec, WORK, codec) for codec in ("trained", "deflate")), ".")
    copy_tree(where)
    whole = run("make -j2 BUILD=build build/bin/farfield-fly && " + FLIGHT % "trained", where)
    result = "ok" if baked.returncode == whole.returncode == 0 else "not ok"
    print("%s - the flight is flown when nothing is broken" % result, flush=True)
    for name, old, new, what, runs in BREAKS:
        stops, how = what_stops(where, name, old, new, runs)
        stopped += stops
        print("# %s %s: %s: %s" % ("stops:" if stops else "GOES BY:", name, what, how), flush=True)
    shutil.rmtree(where, ignore_errors=True)
    held = stopped >= MUST_STOP
    print("%s - %d of %d broken bounds stop at an assertion, at least %d must" % ("ok" if held else "not ok", stopped, len(BREAKS), MUST_STOP))
    return result != "ok" or not held


sys.exit(main())
