#!/usr/bin/env python3
"""newcomer.py: a newcomer's changes stay small, and work at once. Each change is made in a copy of the tree: rows and files of its own go
in, nothing else is touched; the copy is built and the change is tried. Prints TAP lines with the files and lines each change took."""
import os
import shutil
import sys

from tree_copy import copy_tree, run

WORK = "build/tests/newcomer"
GRID = "--raw 65x65 --spacing 30 --tile-log2 5 --quiet"

PLAIN_CODEC = """\
/* Codec "plain", a newcomer's: error codes, then every value as 16 bits, high byte first. */
#include "ff_codec_local.h"

int ff_plain_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                    ff_residuals *out)
{
    int rc = ff_take_errors(in, FF_ERRORS_EACH, contents->errors, out);
    (void)dec;
    if (rc != FF_OK) return rc;
    if (ff_payload_left(in) < 2 * (size_t)contents->count) return FF_ERR_FORMAT;
    for (uint32_t i = 0; i < contents->count; i++, in->at += 2) {
        uint32_t word = (uint32_t)in->at[0] << 8 | in->at[1];
        out->value[i] = i < contents->corners ? (int32_t)word : (int16_t)word;
    }
    return FF_OK;
}

#ifdef FF_ENCODER
size_t ff_plain_encode(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *decoded,
                       const ff_contents *contents, const ff_residuals *res, uint8_t *out)
{
    size_t bytes = ff_put_errors(res, FF_ERRORS_EACH, contents->errors, out);
    (void)info, (void)parent, (void)decoded;
    for (uint32_t i = 0; i < contents->count; i++) {
        out[bytes++] = (uint8_t)((uint32_t)res->value[i] >> 8);
        out[bytes++] = (uint8_t)res->value[i];
    }
    return bytes;
}
#endif
"""

# A note of the server's on a tile: no section of a pack, answered from a constant, held by the client when it has come.
NOTE_CLIENT = """\
/* Kind "note", a newcomer's: a short text on a tile. */
#include "../ff_client_local.h"
#include "ff_intake_local.h"

#include <string.h>

int ff_intake_note(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    (void)intake;
    if (answer->u.data.byte_count >= sizeof ((ff_client *)0)->note) return FF_ERR_RANGE;
    memcpy(item->room, answer->u.data.bytes, answer->u.data.byte_count);
    ((char *)item->room)[answer->u.data.byte_count] = 0;
    return FF_OK;
}

int ff_client_take_note(ff_client *client, ff_new_item *item, int64_t now_us)
{
    (void)now_us;
    strcpy(client->note, (const char *)item->room);
    return 0;
}
"""

NOTE_SERVER = """\
/* Kind "note", a newcomer's: tile 0 alone has one. */
#include "ff_session_local.h"

static int fetch_note(const ff_session *session, enum ff_kind kind, unsigned layer, ff_key key,
                      const uint8_t **payload)
{
    static const char note[] = "mind the gap";
    (void)session, (void)kind, (void)layer;
    *payload = (const uint8_t *)note;
    return ff_key_tile(key) == 0 ? (int)sizeof note - 1 : FF_ERR_NOT_FOUND;
}

int ff_session_ask_note(ff_session *session, const ff_message *ask)
{
    return ff_session_queue(session, ask, fetch_note);
}
"""

NOTE_TEST = """\
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static ff_request_counts ask(client_rig *rig, uint32_t tile)
{
    ff_requests *requests = &rig->client->first.requests;
    ff_request_counts counts;
    ff_requests_rank_begin(requests);
    ff_requests_want(requests, FF_KIND_NOTE, ff_key_make(tile, 0, 0), FF_CLASS_FIRST, 1, 0, NULL);
    ff_requests_rank_end(requests);
    assert_true(rig_settle(rig, 400));
    ff_requests_get_counts(requests, &counts, NULL);
    return counts;
}

static void a_note_comes_or_is_refused(void **state)
{
    client_rig rig;
    (void)state;
    rig_open(&rig, 0);
    rig_client(&rig, 1 << 21);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(ask(&rig, 0).of[FF_KIND_NOTE].sent, 1);
    assert_string_equal(rig.client->note, "mind the gap");
    assert_int_equal(ask(&rig, 1).failed, 1);
    assert_int_equal(rig.asked[FF_KIND_NOTE], 2);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_note_comes_or_is_refused) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
"""

# name; most files; insertions (file, the line to insert before, lines, in which @LINE@ is that line itself); new files; what to build; commands, with what must be in their output
CHANGES = [
    ("a link profile", 1, [("sim/link/sim_link_profiles.c", '        .name = "lan",', """\
        .name = "lorawan",
        .source = "a newcomer's: EU868 DR5, 5470 bit/s, one frame in some seconds",
        .way = {
            [SIM_DOWN] = { .bytes_s = 680, .delay_us = 500000, .jitter_us = 1000000, .queue_bytes = 8192 },
            [SIM_UP] = { .bytes_s = 680, .delay_us = 500000, .jitter_us = 1000000, .queue_bytes = 8192 },
        },
        .connect_ms = 2000,
    },
    {
""")], {}, ["build/bin/farfield-link", "build/bin/farfield-fly", "build/tests/test_link_profiles"],
     [("build/bin/farfield-link --list", "lorawan"), ("build/tests/test_link_profiles", "PASSED"),
      ("build/bin/farfield-fly --pack hills.ffp --link lorawan --seconds 5 --settle 5 --backend none --json", "geometry_hash")]),
    ("a codec", 2, [("protocol/codec/ff_codec_list.h", "    ROW(3,",
                     '@LINE@ \\\n    ROW(4, PLAIN, "plain", NOTHING, 0, 1, ff_no_memory, ff_plain_decode, ff_interpolate, ff_add_residuals, ff_make_residuals, ff_plain_encode)\n')],
     {"protocol/codec/ff_codec_plain.c": PLAIN_CODEC},
     ["build/bin/farfield-bake", "build/bin/farfield-info", "build/bin/farfield-export", "build/bin/farfield-fly"],
     [("build/bin/farfield-bake ../hills.raw %s --codec plain -o plain.ffp" % GRID, ""),
      ("build/bin/farfield-info --verify plain.ffp", "plain"),
      ("build/bin/farfield-export plain.ffp -o plain.r16 && build/bin/farfield-export hills.ffp -o own.r16 && cmp plain.r16 own.r16", ""),
      ("build/bin/farfield-fly --pack plain.ffp --link lan --seconds 2 --settle 5 --backend none --json", "geometry_hash")]),
    ("an option", 2, [("sim/fly/fly_options.h", '    OPTION(sys_text, csv_path, "csv"',
                       '    OPTION(sys_whole, laps, "laps", "N", "1", SYS_WHOLE(1, 9, "laps"), "how often") \\\n'),
                      ("sim/fly/fly_main.c", "    fly_options_print(&options);", '    printf("laps %u\\n", options.laps);\n')],
     {}, ["build/bin/farfield-fly"],
     [("build/bin/farfield-fly --help", "--laps N                how often (1 to 9 laps; default 1)"),
      ("build/bin/farfield-fly --pack hills.ffp --laps 10 || [ $? = 2 ]", "farfield-fly: --laps: 10 is not a whole number from 1 to 9 laps"),
      ("build/bin/farfield-fly --pack hills.ffp --laps 7 --link lan --seconds 2 --settle 5 --backend none", "laps 7")]),
    ("a kind", 5, [("protocol/ff_kind.h", "    X(FAR,",
                    "@LINE@ \\\n    X(NOTE,       note,       12, 0, NODE,     96, PAYLOAD, 0, 0,                           OVERHEAD, 0, note)\n"),
                   ("client/ff_client_local.h", "    ff_turn turn;", "    char note[32];\n")],
     {"client/ask/ff_intake_note.c": NOTE_CLIENT, "server/session/ff_session_note.c": NOTE_SERVER, "tests/client/test_note.c": NOTE_TEST},
     ["build/bin/farfield-fly", "build/tests/test_note", "build/tests/test_client", "build/tests/test_message", "build/tests/test_pack"],
     [("build/tests/test_%s" % suite, "PASSED") for suite in ("note", "client", "message", "pack")] +
     [("build/bin/farfield-fly --pack hills.ffp --link lan --seconds 2 --settle 5 --backend soft --json", "PLAIN_HASH")]),
    ("a way to draw", 5, [("client/farfield.h", '    X(NO_FOG, "no-fog"',
                           '    X(DARK_MESH, "dark-mesh", "d", "dark mesh", "the mesh in black") \\\n'),
                          ("client/ground/ff_show.c", "void ff_show_over(", """\
static void show_dark(const ff_terrain_view *view, const ff_drawn *drawn, const c3d_draw *ground)
{
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    for (unsigned i = 0; i < strips; i++) draw_lines(view, ground, strip[i], 0xFF000000u);
}

"""), ("client/ground/ff_show.c", "    if (show & FF_SHOW_NODE_BORDERS)",
       "    if (show & FF_SHOW_DARK_MESH) show_dark(view, drawn, ground);\n")],
     {}, ["build/bin/farfield-fly", "build/bin/farfield-view"],
     [("build/bin/farfield-fly --help", "--dark-mesh"), ("build/bin/farfield-view --help", "--dark-mesh"),
      ("build/bin/farfield-fly --pack hills.ffp --link lan --seconds 2 --settle 5 --backend soft --json --dark-mesh", "!PLAIN_HASH")]),
]


def insert(where, path, anchor, text):
    """1 when the anchor stands there: a change whose place is gone must be told, not skipped."""
    path = os.path.join(where, path)
    lines = open(path).read().split("\n")
    at = next((i for i, line in enumerate(lines) if line.startswith(anchor)), None)
    if at is None:
        return 0
    if "@LINE@" in text:  # the row comes after it
        text, lines[at:at + 1] = text.replace("@LINE@", lines[at]), []
    lines[at:at] = text.rstrip("\n").split("\n")
    open(path, "w").write("\n".join(lines))
    return 1


def frame_hash(text):
    return [line for line in text.split("\n") if "frame_hash" in line]


def expected(wanted, output, plain):
    if wanted in ("PLAIN_HASH", "!PLAIN_HASH"):
        return frame_hash(output) not in ([], plain) if wanted[0] == "!" else frame_hash(output) == plain != []
    return wanted in output


def why_not(change, where):
    """None, or what went wrong."""
    name, files_max, insertions, own, targets, commands = change
    for path, anchor, text in insertions:
        if not insert(where, path, anchor, text):
            return "%s has no line %r" % (path, anchor)
    for path, text in own.items():
        open(os.path.join(where, path), "w").write(text)
    touched = len({path for path, _, _ in insertions} | set(own))
    if touched > files_max:
        return "touches %d files, at most %d" % (touched, files_max)
    plain = frame_hash(run("../../../bin/farfield-fly --pack ../hills.ffp --link lan --seconds 2 --settle 5 --backend soft --json", where).stdout)
    built = run("make -j2 BUILD=build %s" % " ".join(targets), where)
    if built.returncode:
        return "does not build:\n" + built.stdout[-2000:]
    for command, wanted in commands:
        done = run(command.replace("hills.ffp", "../hills.ffp"), where)
        if done.returncode or not expected(wanted, done.stdout, plain):
            return "%s: %s" % (command, done.stdout[-1000:])
    return None


def size_of(change):
    _, _, insertions, own, _, _ = change
    lines = sum(text.count("\n") for _, _, text in insertions) + sum(text.count("\n") for text in own.values())
    return "%d files, %d lines" % (len({path for path, _, _ in insertions} | set(own)), lines)


def bake(path):
    samples = bytes(b for y in range(65) for x in range(65) for b in ((700 + 9 * x + 5 * y + 80 * ((x // 8 + y // 8) % 2)).to_bytes(2, "little")))
    open(path + ".raw", "wb").write(samples)
    return run("build/bin/farfield-bake %s.raw %s -o %s.ffp" % (path, GRID, path), ".").returncode


def main():
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
    os.makedirs(WORK, exist_ok=True)
    failures = bake(WORK + "/hills")
    print("%sok - a pack to fly over" % ("not " if failures else ""))
    for number, change in enumerate(CHANGES):
        where = "%s/%d" % (WORK, number)
        copy_tree(where)
        wrong = why_not(change, where)
        print("%sok - %s: %s" % ("not " if wrong else "", change[0], size_of(change)), flush=True)
        if wrong:
            failures += 1
            print("# " + wrong.replace("\n", "\n# "))
        shutil.rmtree(where, ignore_errors=True)
    return failures > 0


sys.exit(main())
