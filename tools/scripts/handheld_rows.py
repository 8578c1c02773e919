#!/usr/bin/env python3
"""Which row of a table an object file of the handheld counts to: of the instruction bench (bench_handheld.py) and of the sizes
(size_handheld.py). A row names rooms ("client/ask/"), objects ("client/ask/ff_request.o") and libraries ("libz.a"); the longest name that
fits counts. An object that no row names is an error, and so is a name that no object has.

Run by itself it reads the objects of the program and says what is wrong: make -s handheld-objects | tools/scripts/handheld_rows.py"""
import os
import sys

# ---- instructions: rows of the table "where it goes" (phase, what) ----
JPEG = ("decode", "JPEG: images, faces, paint")
FINS = ("decode", "fins")
INFLATE = ("decode", "inflate and residuals")
LINK = ("decode", "link, messages, queue")
TAKE_IN = ("take in", "")
PANORAMA = ("select", "panorama and far set rules")
WISHES = ("select", "wishes, queue, prefetch")
IMAGES = ("select", "images")
HORIZON = ("select", "what near ground hides")
MEASURE = ("select", "measure, restrict, cull, order")
TRANSFORM = ("transform", "to the screen")
THROW = ("transform", "to a thrown picture")
PERSPECTIVE = ("rasterise", "triangles in perspective")
SMALL = ("rasterise", "small triangles")
SPANS = ("rasterise", "spans")
THROWN = ("rasterise", "thrown pictures")
BACKDROP = ("rasterise", "sky and panorama")
STRIPS = ("rasterise", "strips, clearing")
STITCH = ("stitch", "strips chosen, draws set up")
MARKS = ("work", "update", "draw")  # of the program: ff_client_work, ff_client_update, ff_client_draw

PLACES = {  # what each counts to under each mark; None: it has nothing to do there, and it is an error when it has
    "client/ahead/": (None, WISHES, None),
    "client/ask/": (LINK, WISHES, None),
    "client/ask/ff_intake.o client/ask/ff_new_data.o": (LINK, TAKE_IN, None),
    "client/balance/": (None, MEASURE, STITCH),
    "client/client.o client/client_update.o client/client_figures.o": (LINK, MEASURE, STITCH),
    "client/client_carve.o client/ff_budget.o client/ff_arena.o": (None, PANORAMA, None),
    "client/client_geo.o": (None, None, STITCH),
    "client/client_rank.o client/client_view.o": (None, WISHES, None),
    "client/client_source.o client/client_layers.o": (LINK, WISHES, None),
    "client/client_take.o": (None, TAKE_IN, None),
    "client/ff_sky.o": (None, PANORAMA, STITCH),
    "client/far/": (None, PANORAMA, STITCH),
    "client/far/ff_intake_far.o": (JPEG, None, None),
    "client/ground/": (None, MEASURE, STITCH),
    "client/images/": (JPEG, IMAGES, STITCH),
    "client/map/": (None, MEASURE, STITCH),
    "client/panorama/": (None, PANORAMA, STITCH),
    "client/panorama/ff_intake_face.o": (JPEG, None, None),
    "client/several/": (None, WISHES, None),
    "client/source/": (LINK, WISHES, None),
    "client/terrain/ff_estimate.o client/terrain/ff_estimate_beyond.o client/terrain/ff_estimate_far.o client/terrain/ff_gaze.o": (None, PANORAMA, None),  # by far auto alone
    "client/terrain/ff_evict.o client/terrain/ff_tree.o": (None, TAKE_IN, STITCH),
    "client/terrain/ff_foresee.o client/terrain/ff_reserve.o client/terrain/ff_sides.o client/terrain/ff_wish.o": (None, WISHES, STITCH),
    "client/terrain/ff_grounds.o client/terrain/ff_cover.o client/terrain/ff_seam.o client/terrain/ff_seam_dive.o client/terrain/ff_seam_rim.o": (None, MEASURE, STITCH),
    "client/terrain/ff_limit.o client/terrain/ff_measure.o client/terrain/ff_pool.o client/terrain/ff_restrict.o client/terrain/ff_select.o": (None, MEASURE, STITCH),
    "client/terrain/ff_spread.o": (None, MEASURE, None),
    "client/terrain/ff_horizon.o client/terrain/ff_horizon_raise.o": (None, HORIZON, None),
    "client/terrain/ff_shade.o client/terrain/ff_sort.o client/terrain/ff_strips.o client/terrain/ff_strips_without.o client/terrain/ff_surface.o": (None, MEASURE, STITCH),
    "client/terrain/ff_view_cull.o client/terrain/ff_pack_source.o": (None, MEASURE, STITCH),
    "common3d/c3d_camera.o common3d/c3d_fixed.o": (LINK, MEASURE, STITCH),
    "common3d/c3d_device.o common3d/c3d_edges.o common3d/c3d_pool.o common3d/c3d_text.o": (None, TAKE_IN, STITCH),
    "common3d/c3d_font.o": (None, None, STITCH),
    "common3d/soft/c3d_soft.o common3d/soft/soft_triangle.o": (None, TAKE_IN, STRIPS),
    "common3d/soft/soft_backdrop.o common3d/soft/soft_texture.o common3d/soft/soft_texture_rows.o": (None, TAKE_IN, BACKDROP),
    "common3d/soft/soft_clip.o common3d/soft/soft_transform.o": (None, TAKE_IN, TRANSFORM),
    "common3d/soft/soft_line.o common3d/soft/soft_pixels.o common3d/soft/soft_spans.o": (None, TAKE_IN, SPANS),
    "common3d/soft/soft_label.o common3d/soft/soft_point.o": (None, None, STRIPS),
    "common3d/soft/soft_perspective.o": (None, TAKE_IN, PERSPECTIVE),
    "common3d/soft/soft_thrown.o": (None, TAKE_IN, THROW),
    "common3d/soft/soft_thrown_rows.o common3d/soft/soft_thrown_strip.o common3d/soft/soft_thrown_tiny.o": (None, TAKE_IN, THROWN),
    "common3d/soft/soft_small.o common3d/soft/soft_tiny.o common3d/soft/soft_tiny_colours.o": (None, TAKE_IN, SMALL),
    "platform/": (LINK, MEASURE, STITCH),
    "platform/posix/jpeg.o platform/posix/jpeg_tables.o": (JPEG, None, None),
    "protocol/": (LINK, MEASURE, STITCH),
    "protocol/codec/": (INFLATE, TAKE_IN, None),
    "protocol/codec/ff_decode.o": (INFLATE, TAKE_IN, STITCH),  # a node's error: is it within the view?
    "protocol/far/": (FINS, TAKE_IN, STITCH),
    "protocol/geo/": (None, None, STITCH),
    "protocol/shape/": (LINK, MEASURE, STITCH),
    "protocol/message/": (LINK, None, None),
    "protocol/message/ff_message_view.o": (LINK, WISHES, None),
    "protocol/message/ff_face_columns.o": (JPEG, None, None),
    "protocol/zlib/": (INFLATE, None, None),
    "sim/": (LINK, MEASURE, STITCH),
    "libc.a libgcc.a libgcc_eh.a crt": (LINK, MEASURE, STITCH),
    "libjpeg.a": (JPEG, None, None),
    "libz.a": (INFLATE, None, None),
}
# These work for others: what they cost counts to the object that called them.
HELPERS = ("libgcc.a", "libc.a(mem", "common3d/c3d_fixed.o", "protocol/ff_key.o", "protocol/ff_bytes.o", "protocol/shape/ff_shape_planar.o")

# ---- sizes: rows of the table of parts ----
PARTS = {
    "protocol/": "protocol",
    "client/terrain/": "client/terrain",
    "client/": "client",
    "common3d/soft/": "common3d/soft",
    "common3d/": "common3d",
    "platform/": "platform",
    "sim/": "program",
    "libz.a": "zlib",
    "libjpeg.a": "libjpeg",
    "libc.a crt1.o crti.o crtn.o": "libc",
    "libgcc.a libgcc_eh.a crtbegin crtend": "libgcc",
}
LIBRARIES = ("lib", "crt")


class NoRow(Exception):
    pass


def place_of(path):
    """client/ask/ff_request.o of build/handheld/obj/client/ask/ff_request.o, libc.a(memcpy.o) of /usr/lib/libc.a(memcpy.o)."""
    return path.split("/obj/")[1] if "/obj/" in path else os.path.basename(path)


class Rows:
    """One of the tables above, by place."""

    def __init__(self, table, name):
        self.name = name
        self.rows = {place: row for places, row in table.items() for place in places.split()}
        self.longest_first = sorted(self.rows, key=len, reverse=True)

    def named(self, place):
        return next((name for name in self.longest_first if place.startswith(name)), None)

    def of(self, place):
        name = self.named(place)
        if name is None:
            raise NoRow("no row for %s: add it to %s in tools/scripts/handheld_rows.py" % (place, self.name))
        return self.rows[name]

    def unused(self, places):
        """Names that none of the places has; libraries are linked as they are needed."""
        used = {self.named(place) for place in places}
        return [name for name in self.rows if name not in used and not name.startswith(LIBRARIES)]


BENCH, SIZES = Rows(PLACES, "PLACES"), Rows(PARTS, "PARTS")


def phase_of(mark, place):
    row = BENCH.of(place)[MARKS.index(mark)]
    if row is None:
        raise NoRow("%s is at work under the mark \"%s\": say in PLACES in tools/scripts/handheld_rows.py what it counts to there" % (place, mark))
    return row


def is_helper(place):
    return place.startswith(HELPERS)


def without_row(places):
    """What the tables lack for a program of these objects."""
    found = []
    for rows in (BENCH, SIZES):
        for place in sorted(places):
            try:
                rows.of(place)
            except NoRow as what:
                found.append(str(what))
    return found


def without_object(places):
    """What the tables name and a program of these objects has not."""
    names = [(name, rows.name) for rows in (BENCH, SIZES) for name in rows.unused(places)]
    names += [(name, "HELPERS") for name in HELPERS if not name.startswith(LIBRARIES) and name not in places]
    return ["there is no %s: take it out of %s in tools/scripts/handheld_rows.py" % name for name in names]


if __name__ == "__main__":
    objects = sys.stdin.read().split()
    wrong = without_row(objects) + without_object(objects)
    sys.exit("\n".join(wrong) if wrong else 0)
