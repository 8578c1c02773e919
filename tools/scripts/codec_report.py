"""codec.md, from the rows of bench_codec.py."""

# (codec, tables), the name of its column
COLUMNS = [(("trained", "held out"), "trained, held out"), (("trained", "built in"), "trained, built in"), (("deflate", ""), "deflate"),
           (("rice", ""), "rice"), (("raw", ""), "raw"), (("JPEG-LS", ""), "JPEG-LS"), (("LERC", ""), "LERC"), (("JPEG 2000", ""), "JPEG 2000"),
           (("JPEG XL", ""), "JPEG XL")]
PIECES = (0, 65, 17, 9)
# Bits a sample with nodes of 17 that are to be reached, rims sent once, by ground, for its errors in turn.
TARGETS = {"aconcagua": (5.10, 3.52, 2.08, 1.18), "fuji": (4.98, 3.44, 2.04, 1.18), "puget": (None, 4.40, 2.64, 1.61),
           "slovenia": (4.55, 2.24, 0.60, 0.19)}
NINE_MORE = (3, 4.5, 6.5, 9)  # percent that nodes of 9 may take more, likewise
ABOUT = """# Bits, errors and instructions of heights

%s

Bits a sample of the ground at the same largest error. Ours are packs: all bytes of their records, with codes
of errors and of leaves, and heights of rims once for each of both sides; in brackets what travels to one who fetches all of it, no side of a node twice; without the 2 bytes that a NODE message adds. Others' are bare streams
with their headers: JPEG-LS (near-lossless) and LERC keep the bound themselves; for JPEG 2000 and JPEG XL (effort 7), and where JPEG-LS can
tell no such bound (more than 255 steps), heights were quantised with twice the bound and one step, and coded without loss. Of others' pieces
60 were taken by chance, and a piece of 17 x 17 counts as 256 samples, as a node does. "Held out": tables trained on all grounds but this one.
"""
COUNTED = """Of an ARM11 without FPU, counted exactly under qemu, for each sample of the ground. Ours (armv6, -O2): decoding and reconstruction of all
levels, nodes of 17 / 9, with the tables that are built in; in brackets for each height made, rims twice. Others': whole grounds, from memory to
memory, by Debian's libraries for armel (armv5), without what making heights of quantised ones takes; JPEG XL's library computes in floating point.
"""


def table(head, lines):
    cells = ["| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *lines]]
    return "\n".join(cells) + "\n"


def metres(value):
    return "%g m" % value if value >= 1 or not value else "%g cm" % (100 * value)


class Rows:
    def __init__(self, result):
        self.found = {(r["ground"], r["error_m"], r["codec"], r["tables"], r["piece"]): r for r in result["rows"]}
        self.cases = [(g["name"], error) for g in result["grounds"] for error in g["errors"]]
        here = {key[2:4] for key in self.found}
        self.columns = [(key, name) for key, name in COLUMNS if key in here]

    def of(self, case, key, piece):
        return self.found.get((*case, *key, piece))

    def lines(self, columns, cell, pieces=PIECES):
        """A line a ground and error; of each codec the pieces there are."""
        for case in self.cases:
            rows = [[self.of(case, key, piece) for piece in pieces] for key, _ in columns]
            yield [case[0], metres(case[1])] + [" / ".join(cell(row) for row in found if row and cell(row)) for found in rows]


def bits_of(row):
    once = row.get("bits_once", row["bits"])
    return "%.2f" % row["bits"] + (" (%.2f)" % once if once < row["bits"] else "")


def bits_table(rows):
    head = ["ground", "error"] + [name + (" 17² / 9²" if rows.of(rows.cases[0], key, 0) is None else " whole / 65² / 17² / 9²")
                                  for key, name in rows.columns]
    return table(head, rows.lines(rows.columns, bits_of))


def errors_table(rows):
    columns = [c for c in rows.columns if c[0] != ("trained", "built in")]
    cell = lambda row: "%.3g, %.3g" % (row["max_m"], row["rms_m"]) if "max_m" in row and row["piece"] != 9 else ""
    return table(["ground", "error"] + [name for _, name in columns], rows.lines(columns, cell))


def counts_table(rows):
    columns = [c for c in rows.columns if any("instructions" in row for row in rows.found.values() if (row["codec"], row["tables"]) == c[0])]
    cell = lambda row: "" if "instructions" not in row else "%.0f" % row["instructions"] + (" (%.0f)" % row["instructions_made"] if row["piece"] else "")
    return table(["ground", "error"] + [name for _, name in columns], rows.lines(columns, cell)) if columns else ""


def targets_table(rows, grounds):
    lines = []
    for ground in grounds:
        for i, (error, target) in enumerate(zip(ground["errors"], TARGETS.get(ground["name"], ()))):
            case, key = (ground["name"], error), COLUMNS[0][0]
            wide, small = rows.of(case, key, 17), rows.of(case, key, 9)
            if target and wide and small:
                bits, nine = wide["bits_once"], small["bits_once"]
                lines.append([case[0], metres(error), "%.2f" % target, "%.2f" % bits, "%+.1f %%" % (100 * (bits / target - 1)),
                              "%g %%" % NINE_MORE[i], "%+.1f %%" % (100 * (nine / bits - 1))])
    head = ["ground", "error", "target, 17²", "held out, 17²", "off", "target, 9² more", "9² more"]
    return table(head, lines) if lines else ""


def write(path, result, plots):
    rows = Rows(result)
    text = [ABOUT % result["about"], *["- %s\n" % note for note in result["notes"]], "\n## Bits\n", bits_table(rows)]
    for heading, about, body in (("Targets", "Sides of nodes once; where streams apart miss one by at most 0.03 bits it counts as met.\n", targets_table(rows, result["grounds"])),
                                 ("Errors", "The largest, and RMS, in metres; nodes of 17, others whole.\n", errors_table(rows)),
                                 ("Instructions", COUNTED, counts_table(rows))):
        if body:
            text += ["\n## %s\n" % heading, about, body]
    text += ["\n## Plots\n"] + ["![%s](%s)\n" % (title, name) for name, title in plots]
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(text))
