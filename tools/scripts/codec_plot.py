"""Plots of codec.md: SVG, a panel for each ground, a line for each codec and size of piece, of older and others' codecs fewer than in the tables."""
import math

PANEL, GAP, LEFT, TOP, ACROSS = (440, 300), (60, 50), 50, 100, 2
# codec, tables: colour and name
CODECS = {("trained", "held out"): ("#0b62a8", "trained, held out"), ("trained", "built in"): ("#0b62a8", "trained, built in"),
          ("deflate", ""): ("#c25a00", "deflate"), ("rice", ""): ("#8a5a2a", "rice"), ("raw", ""): ("#555555", "raw"),
          ("JPEG-LS", ""): ("#2a8a4a", "JPEG-LS"), ("LERC", ""): ("#b02a8a", "LERC"), ("JPEG 2000", ""): ("#c7a500", "JPEG 2000"),
          ("JPEG XL", ""): ("#c01818", "JPEG XL")}
DASHES = {0: "", 17: "5 3", 9: "1.5 2.5"}
SIZES = {0: "whole", 17: "17²", 9: "9²"}


class Axis:
    """Logarithmic along `length`."""

    def __init__(self, values, length):
        self.low, self.high = math.log(min(values) / 1.1), math.log(max(values) * 1.1)
        self.length = length

    def at(self, value):
        return self.length * (math.log(value) - self.low) / (self.high - self.low)

    def grid(self):
        for exponent in range(-3, 7):
            for digit in (1, 2, 5):
                value = digit * 10.0 ** exponent
                if self.low <= math.log(value) <= self.high:
                    yield value


class Levels:
    """Evenly along `length`: errors, of which the least is 0."""

    def __init__(self, values, length):
        self.values, self.length = sorted(set(values)), length

    def at(self, value):
        return self.length * (self.values.index(value) + 0.5) / len(self.values)

    def grid(self):
        return self.values


def panel(corner, title, lines, across, up, names):
    """lines: (codec, piece, points)."""
    x0, y0 = corner[0], corner[1] + PANEL[1]
    svg = ['<text x="%d" y="%d">%s</text>' % (corner[0], corner[1] - 6, title)]
    for value in across.grid():
        x = x0 + across.at(value)
        svg.append('<path d="M%.1f %d v%d" stroke="#e4e4e4"/><text x="%.1f" y="%d" text-anchor="middle" class="s">%g</text>'
                   % (x, corner[1], PANEL[1], x, y0 + 12, value))
    for value in up.grid():
        y = y0 - up.at(value)
        svg.append('<path d="M%d %.1f h%d" stroke="#e4e4e4"/><text x="%d" y="%.1f" text-anchor="end" class="s">%g</text>'
                   % (x0, y, PANEL[0], x0 - 4, y + 3, value))
    svg.append('<rect x="%d" y="%d" width="%d" height="%d" fill="none" stroke="#999"/>' % (*corner, *PANEL))
    svg.append('<text x="%d" y="%d" text-anchor="middle" class="s">%s</text>' % (x0 + PANEL[0] / 2, y0 + 25, names[0]))
    svg.append('<text transform="translate(%d %d) rotate(-90)" text-anchor="middle" class="s">%s</text>' % (x0 - 32, y0 - PANEL[1] / 2, names[1]))
    for codec, piece, points in lines:
        colour, name = CODECS[codec]
        places = ["%.1f,%.1f" % (x0 + across.at(x), y0 - up.at(y)) for x, y in points]
        svg.append('<polyline points="%s" fill="none" stroke="%s" stroke-width="%g" stroke-dasharray="%s"><title>%s, %s</title></polyline>'
                   % (" ".join(places), colour, 2 if codec[1] else 1.2, DASHES[piece], name, SIZES[piece]))
        svg += ['<circle cx="%s" cy="%s" r="2.4" fill="%s"/>' % (*place.split(","), colour) for place in places]
    return svg


def legend(lines):
    svg, x = [], LEFT
    for codec in dict.fromkeys(codec for _, found in lines for codec, _, _ in reversed(found)):
        colour, name = CODECS[codec]
        svg.append('<rect x="%d" y="34" width="9" height="9" fill="%s"/><text x="%d" y="43">%s</text>' % (x, colour, x + 14, name))
        x += 30 + 7 * len(name)
    x = LEFT
    for piece in sorted({piece for _, found in lines for _, piece, _ in found}):
        svg.append('<path d="M%d 60 h26" stroke="#000" stroke-width="1.4" stroke-dasharray="%s"/><text x="%d" y="64">%s</text>'
                   % (x, DASHES[piece], x + 32, SIZES[piece] + ("" if piece == 0 else " nodes, pieces")))
        x += 160
    return svg


def plot(path, title, grounds, names, axes):
    """grounds: (title, lines). axes: what makes both of a panel from all its points' x and y."""
    down = -(-len(grounds) // ACROSS)
    width, height = LEFT + min(ACROSS, len(grounds)) * (PANEL[0] + GAP[0]), TOP + down * (PANEL[1] + GAP[1])
    svg = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" viewBox="0 0 %d %d">' % (width, height, width, height),
           '<style>text{font:11px sans-serif}.s{font-size:9px;fill:#555}</style>', '<rect width="100%" height="100%" fill="#fff"/>',
           '<text x="%d" y="20" style="font-size:14px">%s</text>' % (LEFT, title), *legend(grounds)]
    for i, (name, lines) in enumerate(grounds):
        points = [point for _, _, found in lines for point in found]
        across, up = (make([point[j] for point in points], PANEL[j]) for j, make in enumerate(axes))
        corner = (LEFT + i % ACROSS * (PANEL[0] + GAP[0]), TOP + i // ACROSS * (PANEL[1] + GAP[1]))
        svg += panel(corner, name, lines, across, up, names)
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(svg + ["</svg>"]) + "\n")


def lines_of(result, ground, point, chosen):
    """A line for each codec and piece of which `chosen` has points."""
    lines = {}
    for row in result["rows"]:
        key = (row["codec"], row["tables"]), row["piece"]
        if row["ground"] == ground["name"] and chosen(row):
            lines.setdefault(key, []).append(point(row))
    return [(codec, piece, points) for (codec, piece), points in reversed(lines.items())]  # ours above others


def write(out, result):
    """Names and titles of OUT's plots."""
    made = []

    def add(name, title, names, axes, point, chosen):
        grounds = [(ground["title"], lines_of(result, ground, point, chosen)) for ground in result["grounds"]]
        if all(lines for _, lines in grounds):
            plot("%s/%s" % (out, name), title, grounds, names, axes)
            made.append((name, title))

    add("codec-bits.svg", "Error against bits", ("bits a sample", "largest error, m"), (Axis, Levels),
        lambda row: (row["bits"], row["error_m"]), lambda row: row["tables"] != "built in" and row["codec"] != "raw" and row["piece"] in (DASHES if row["tables"] else (0, 17)))
    add("codec-instructions.svg", "Bits against instructions to decode", ("ARM instructions a sample", "bits a sample"), (Axis, Axis),
        lambda row: (row["instructions"], row["bits"]), lambda row: "instructions" in row and row["codec"] != "raw")
    return made
