#!/usr/bin/env python3
"""The rules that front.py judges settings by, over rows that are dicts with triangles, bytes and err_px_p95 (None: not judged).

front_rule.py CSV: for each named setting of such a table of flights (ground, height_m, link, setting, kind, triangles, bytes, err_px_p95)
a line "SETTING POINTS DOMINATED FACTOR GROUND HEIGHT LINK BY"."""
import csv
import math
import sys

MEASURES = ("triangles", "bytes", "err_px_p95")
LEAST = 0.9  # 10 % less: at most this share


def ratio(mine, other):
    """How many times as much mine is; nothing is less than 0."""
    return 0.0 if mine <= 0 else math.inf if other <= 0 else mine / other


def dominates(other, row):
    """10 % fewer triangles, 10 % fewer bytes and 10 % less error, all at once."""
    return all(row[m] > 0 and other[m] <= LEAST * row[m] for m in MEASURES)


def factor(other, row):
    """How many times better `other` is in the measure in which it is least so."""
    return min(ratio(row[m], other[m]) for m in MEASURES)


def judged(rows):
    return [row for row in rows if all(row[m] is not None for m in MEASURES)]


def dominators(row, rows):
    """Those of `rows` that dominate `row`, the worst first."""
    found = [other for other in rows if dominates(other, row)]
    return sorted(found, key=lambda other: (-factor(other, row), other["setting"]))


def front(rows, measures=MEASURES):
    """Those that no other equals or beats in all measures; of equal ones the first."""
    members = []
    for at, row in enumerate(rows):
        mine = [row[m] for m in measures]
        if not any(all(b <= a for a, b in zip(mine, theirs)) and (theirs != mine or before < at)
                   for before, theirs in enumerate([other[m] for m in measures] for other in rows) if before != at):
            members.append(row)
    return sorted(members, key=lambda row: [row[m] for m in measures])


def within(rows, triangles):
    """The one with the least error within so many triangles, and of these with the fewest bytes; None: no such row."""
    return min((r for r in rows if r["triangles"] <= triangles), key=lambda r: (r["err_px_p95"], r["bytes"], r["setting"]), default=None)


def points(rows):
    """Rows by (ground, height, link), in the order in which they come."""
    found = {}
    for row in rows:
        found.setdefault((row["ground"], row["height_m"], row["link"]), []).append(row)
    return found


def standing(rows):
    """Of each named setting: {"points", "dominated", "worst": (factor, row, by) or None}, in the order in which they come."""
    found = {}
    for at in points(judged(rows)).values():
        swept = [row for row in at if row["kind"] == "swept"]
        for row in (row for row in at if row["kind"] == "named"):
            mine = found.setdefault(row["setting"], {"points": 0, "dominated": 0, "worst": None})
            by = dominators(row, swept)
            mine["points"] += 1
            if by:
                mine["dominated"] += 1
                worst = (factor(by[0], row), row, by[0])
                mine["worst"] = worst if not mine["worst"] or worst[0] > mine["worst"][0] else mine["worst"]
    return found


# ---- the balance against fixed settings, window by window: lists of (triangles, bytes since the start, err_px_p95) ----
SAME = 1.05   # as many triangles or bytes: at most so many times


def against_fixed(window, at, fixed):
    """The fixed flight that has the least error in the same window with as many triangles and bytes, and how many times less; or None."""
    others = [(row["windows"][at], row) for row in fixed if at < len(row["windows"])]
    same = [(w, row) for w, row in others if None not in w and w[0] <= SAME * window[0] and w[1] <= SAME * window[1]]
    if not same or None in window:
        return None
    w, row = min(same, key=lambda pair: (pair[0][2], pair[1]["setting"]))
    return (1.0 if window[2] <= w[2] else ratio(window[2], w[2])), row


def needs_more(row, budget, fixed):
    """Does the ground need the budget: is there a fixed setting that draws more than it for at least a fifth less error?"""
    return any(other["triangles"] > budget and other["err_px_p95"] <= 0.8 * row["err_px_p95"] for other in fixed)


def read(path):
    """The rows of a table of flights, with numbers where there are some."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text or None
    with open(path, newline="", encoding="utf-8") as table:
        return [{name: value(text) for name, text in row.items()} for row in csv.DictReader(table)]


if __name__ == "__main__":
    for name, s in standing(read(sys.argv[1])).items():
        line = [name, s["points"], s["dominated"]]
        if s["worst"]:
            much, row, by = s["worst"]
            line += ["%.3f" % much, row["ground"], "%g" % row["height_m"], row["link"], by["setting"]]
        print(*line)
