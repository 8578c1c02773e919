#!/usr/bin/env python3
"""Plots of front.md: SVG, a panel for each ground and height, error against triangles or bytes, both logarithmic."""
import math

import front_rule

PANEL, GAP, LEFT, TOP, FOOT = (250, 180), (14, 34), 50, 84, 10
SPANS = {"triangles": (100, 300000), "bytes": (1000, 2000000)}
ERRORS = (0.01, 100)
GRID = {"triangles": (100, 1000, 10000, 100000), "bytes": (1000, 10000, 100000, 1000000)}
COLOURS = {"C": "#c25a00", "px": "#0b62a8", "depth": "#8a8a8a"}


def kind_of(setting):
    quality = setting.split()[0]
    return "px" if quality.startswith("px:") else "C" if quality.endswith(":0") else "depth"


def has_panorama(setting):
    return setting.split(",")[0].endswith(" on")


def share(value, span):
    """0 to 1 along a logarithmic axis; what lies beyond it stands at its end."""
    low, high = (math.log(end) for end in span)
    return (min(max(math.log(max(value, 1e-9)), low), high) - low) / (high - low)


def short(value):
    return "%gM" % (value / 1e6) if value >= 1e6 else "%gk" % (value / 1e3) if value >= 1000 else "%g" % value


def label(setting):
    short_names = {"default": "D", "low": "L", "medium": "M", "high": "H", "paper-low": "pL", "paper-high": "pH"}
    return short_names.get(setting) or "b" + short(float(setting.split()[1]))


class Panel:
    def __init__(self, x, y, what, target):
        self.x, self.y, self.what, self.target, self.svg = x, y, what, target, []

    def place(self, row):
        return self.at(row[self.what], row["err_px_p95"])

    def at(self, value, error):
        return (self.x + PANEL[0] * share(value, SPANS[self.what]), self.y + PANEL[1] * (1 - share(error, ERRORS)))

    def line(self, start, end, style):
        self.svg.append('<line x1="%.1f" y1="%.1f" x2="%.1f" y2="%.1f" %s/>' % (*start, *end, style))

    def frame(self, title):
        for value in GRID[self.what]:
            self.line(self.at(value, ERRORS[0]), self.at(value, ERRORS[1]), 'stroke="#e4e4e4"')
            x, y = self.at(value, ERRORS[0])
            self.svg.append('<text x="%.1f" y="%.1f" text-anchor="middle" class="s">%s</text>' % (x, y + 12, short(value)))
        for error in (0.01, 0.1, 1, 10, 100):
            self.line(self.at(SPANS[self.what][0], error), self.at(SPANS[self.what][1], error), 'stroke="#e4e4e4"')
        dashed = 'stroke="#2a8a4a" stroke-dasharray="4 3"'
        self.line(self.at(SPANS[self.what][0], self.target["err_px_p95"]), self.at(SPANS[self.what][1], self.target["err_px_p95"]), dashed)
        if self.what == "triangles":
            self.line(self.at(self.target["triangles"], ERRORS[0]), self.at(self.target["triangles"], ERRORS[1]), dashed)
        self.svg.append('<rect x="%d" y="%d" width="%d" height="%d" fill="none" stroke="#999"/>' % (self.x, self.y, *PANEL))
        self.svg.append('<text x="%d" y="%d">%s</text>' % (self.x, self.y - 5, title))

    def errors(self):
        for error in (0.01, 0.1, 1, 10, 100):
            x, y = self.at(SPANS[self.what][0], error)
            self.svg.append('<text x="%.1f" y="%.1f" text-anchor="end" class="s">%g</text>' % (x - 4, y + 3, error))

    def staircase(self, rows):
        corners, last = [], None
        for row in front_rule.front(rows, (self.what, "err_px_p95")):
            x, y = self.place(row)
            corners += [(x, last), (x, y)] if last is not None else [(x, y)]
            last = y
        self.svg.append('<polyline points="%s" fill="none" stroke="#444" stroke-width="0.8"/>' % " ".join("%.1f,%.1f" % c for c in corners))

    def swept(self, rows):
        members = {id(row) for row in front_rule.front(rows)}
        for row in rows:
            colour = COLOURS[kind_of(row["setting"])]
            x, y = self.place(row)
            fill = colour if id(row) in members else "none"
            style = 'fill="%s" stroke="%s" stroke-width="0.9"' % (fill, colour)
            title = "<title>%s</title>" % row["setting"]
            if has_panorama(row["setting"]):
                self.svg.append('<rect x="%.1f" y="%.1f" width="5" height="5" %s>%s</rect>' % (x - 2.5, y - 2.5, style, title))
            else:
                self.svg.append('<circle cx="%.1f" cy="%.1f" r="2.8" %s>%s</circle>' % (x, y, style, title))

    def named(self, rows):
        """Diamonds, each with a short name beside it where there is room."""
        places = [(row["setting"], *self.place(row)) for row in rows]
        taken = [(x - 5, y - 5, x + 5, y + 5) for _, x, y in places]
        for setting, x, y in places:
            self.svg.append('<path d="M%.1f %.1f l5 5 l-5 5 l-5 -5 z" fill="#e8c400" stroke="#000"><title>%s</title></path>' % (x, y - 5, setting))
        for setting, x, y in places:
            width = 6 * len(label(setting))
            boxes = [(left, low - 8, left + width, low) for away in range(0, 60, 9) for left, low in (
                (x + 7, y + 3 - away), (x - 7 - width, y + 3 - away), (x + 7, y + 3 + away), (x - 7 - width, y + 3 + away),
                (x - width / 2, y - 7 - away), (x - width / 2, y + 15 + away))]
            inside = [b for b in boxes if b[0] > self.x and b[2] < self.x + PANEL[0] + 4 and b[1] > self.y and b[3] < self.y + PANEL[1]]
            box = next((b for b in inside if not any(overlap(b, other) for other in taken)), boxes[0])
            taken.append(box)
            self.svg.append('<text x="%.1f" y="%.1f" class="n">%s</text>' % (box[0], box[3], label(setting)))


def overlap(one, other):
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def legend(svg):
    x = LEFT
    for text, kind in (("C, all levels", "C"), ("C and depth", "depth"), ("pixels of error", "px")):
        svg.append('<rect x="%d" y="30" width="9" height="9" fill="%s"/><text x="%d" y="39">%s</text>' % (x, COLOURS[kind], x + 14, text))
        x += 120
    svg.append('<rect x="%d" y="31" width="6" height="6" fill="none" stroke="#444"/><text x="%d" y="39">panorama on</text>' % (x, x + 12))
    svg.append('<circle cx="%d" cy="34" r="3.2" fill="none" stroke="#444"/><text x="%d" y="39">off; filled: on the front</text>' % (x + 100, x + 110))
    svg.append('<path d="M%d 46 l5 5 l-5 5 l-5 -5 z" fill="#e8c400" stroke="#000"/>' % (LEFT + 5))
    svg.append('<text x="%d" y="55">D default, L low, M medium, H high, p of the papers, bN balance N</text>' % (LEFT + 14))


def write(out, link, what, rows, target):
    """OUT/front-LINK-WHAT.svg; its name."""
    grounds = list(dict.fromkeys(row["ground"] for row in rows))
    heights = sorted({row["height_m"] for row in rows})
    width = max(LEFT + len(heights) * (PANEL[0] + GAP[0]) + 10, 720)
    height = TOP + len(grounds) * (PANEL[1] + GAP[1]) + FOOT
    svg = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" viewBox="0 0 %d %d">' % (width, height, width, height),
           '<style>text{font:11px sans-serif}.s{font-size:9px;fill:#555}.n{font-size:9px;font-weight:bold;paint-order:stroke;stroke:#fff;stroke-width:2px}</style>',
           '<rect width="100%" height="100%" fill="#fff"/>',
           '<text x="%d" y="18" style="font-size:14px">Error (p95, px) against %s over %s</text>' % (LEFT, "triangles a frame" if what == "triangles" else "bytes of the flight", link)]
    legend(svg)
    for down, ground in enumerate(grounds):
        for across, metres in enumerate(heights):
            here = [row for row in rows if row["ground"] == ground and row["height_m"] == metres]
            if here:
                panel = Panel(LEFT + across * (PANEL[0] + GAP[0]), TOP + down * (PANEL[1] + GAP[1]), what, target)
                panel.frame("%s, %.0f m" % (ground, metres))
                if across == 0:
                    panel.errors()
                swept = [row for row in here if row["kind"] == "swept"]
                panel.staircase(swept)
                panel.swept(swept)
                panel.named([row for row in here if row["kind"] == "named"])
                svg += panel.svg
    name = "front-%s-%s.svg" % (link, what)
    with open("%s/%s" % (out, name), "w", encoding="utf-8") as file:
        file.write("\n".join(svg + ["</svg>"]) + "\n")
    return name
