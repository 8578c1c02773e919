#!/usr/bin/env python3
"""front.md and its plots, from the rows of front.csv (see front.py)."""
import statistics

import front_plot
import front_rule

BUDGETS = (2500, 5500, 20000)  # triangles a frame


def px(value):
    return "–" if value is None else "%.3f" % value if value < 1 else "%.2f" % value


def kb(value):
    return "%.1f" % (value / 1000)


def cost(row):
    return "%.0f triangles, %s kB, %s px" % (row["triangles"], kb(row["bytes"]), px(row["err_px_p95"]))


def at(row):
    return "%s, %.0f m, %s" % (row["ground"], row["height_m"], row["link"])


def table(heads, lines):
    """Markdown: texts stand left, numbers (heads that begin with a hash) right."""
    marks = ["---:" if head.startswith("#") else "---" for head in heads]
    rows = [[head.lstrip("#") for head in heads], marks, *lines]
    return "\n".join("| " + " | ".join(str(cell) for cell in row) + " |" for row in rows) + "\n"


def standing_table(rows):
    lines = []
    for name, s in front_rule.standing(rows).items():
        line = [name, s["points"], s["dominated"]]
        if s["worst"]:
            much, row, by = s["worst"]
            line += ["%.2f" % much, at(row), cost(row), "%s: %s" % (by["setting"], cost(by))]
        lines.append(line + ["–"] * (7 - len(line)))
    return table(["setting", "#points", "#dominated at", "#worst factor", "where", "it", "by"], lines)


def target_table(rows, target):
    lines, missed = [], 0
    for row in rows:
        if row["setting"] != target["setting"] or row["link"] != target["link"] or row["speed_kmh"] != target["speed"]:
            continue
        ok = row["err_px_p95"] is not None and row["err_px_p95"] <= target["err_px_p95"] and row["triangles"] <= target["triangles"]
        missed += not ok
        lines.append([row["ground"], "%.0f, along the edge" % row["height_m"] if row["course"] == "edge" else "%.0f" % row["height_m"],
                      "%.0f" % row["triangles"], px(row["err_px_p95"]), px(row["skyline_px_rms"]), "%.2f" % row["undrawn_px_percent"],
                      kb(row["bytes"]), "hit" if ok else "missed"])
    lines.sort(key=lambda line: (line[0], float(line[1].split(",")[0]), line[1]))
    heads = ["ground", "#metres up", "#triangles", "#p95 px", "#skyline px", "#undrawn %", "#kB", "target"]
    return "%d of %d missed.\n\n%s" % (missed, len(lines), table(heads, lines))


def balance_lines(rows):
    """A line for each balanced flight."""
    lines = []
    for together in front_rule.points(front_rule.judged(rows)).values():
        fixed = [row for row in together if row["kind"] == "swept"]
        for row in together:
            if not row["setting"].startswith("balance "):
                continue
            budget = float(row["setting"].split()[1])
            found = [front_rule.against_fixed(window, number, fixed) for number, window in enumerate(row["windows"])]
            compared = [pair for pair in found if pair]
            worst = max(compared, key=lambda pair: pair[0], default=None)
            used = 100 * row["triangles"] / budget
            needs = front_rule.needs_more(row, budget, fixed)
            lines.append({"row": row, "used": used, "needs": needs, "windows": len(compared), "late": sum(pair[0] > 1.2 for pair in compared),
                          "worst": worst})
    return lines


def balance_tables(rows):
    lines = balance_lines(rows)
    sums, each = [], []
    for setting in dict.fromkeys(line["row"]["setting"] for line in lines):
        mine = [line for line in lines if line["row"]["setting"] == setting]
        needing = [line for line in mine if line["needs"]]
        worst = max((line for line in mine if line["worst"]), key=lambda line: line["worst"][0], default=None)
        sums.append([setting, len(mine), len(needing), sum(line["used"] < 85 for line in needing),
                     "%.0f" % min(line["used"] for line in needing) if needing else "–", sum(line["windows"] for line in mine),
                     sum(line["late"] for line in mine), "%.2f" % worst["worst"][0] if worst else "–",
                     "%s: %s" % (at(worst["row"]), worst["worst"][1]["setting"]) if worst else "–"])
    for line in lines:
        row, worst = line["row"], line["worst"]
        each.append([at(row), row["setting"], "%.0f" % row["triangles"], "%.0f" % line["used"], "yes" if line["needs"] else "no",
                     px(row["err_px_p95"]), kb(row["bytes"]), "%d of %d" % (line["late"], line["windows"]),
                     "%.2f" % worst[0] if worst else "–", worst[1]["setting"] if worst else "–"])
    return (table(["setting", "#flights", "#need the budget", "#of them used < 85 %", "#least used %", "#windows", "#worse by > 20 %", "#worst factor",
                   "where: by"], sums),
            table(["where", "setting", "#triangles", "#used %", "needed", "#p95 px", "#kB", "#worse windows", "#worst factor", "by"], each))


def within_table(rows):
    lines = []
    for together in front_rule.points(front_rule.judged(rows)).values():
        line = [at(together[0])]
        for budget in BUDGETS:
            best = front_rule.within([row for row in together if row["kind"] == "swept"], budget)
            line.append("%s: %s" % (best["setting"], cost(best)) if best else "–")
        lines.append(line)
    return table(["where"] + ["within %d triangles" % budget for budget in BUDGETS], lines)


def family_of(row):
    return front_plot.kind_of(row["setting"]), front_plot.has_panorama(row["setting"])


def families_table(rows):
    """Which measure, and with panoramas or without: the least error of each kind of setting within a budget, as median over the
    points at which it has one, and its bytes."""
    families = list(dict.fromkeys(family_of(row) for row in rows if row["kind"] == "swept"))
    together, lines = front_rule.points(front_rule.judged(rows)), []
    for height in sorted({row["height_m"] for row in rows}):
        here = [group for group in together.values() if group[0]["height_m"] == height]
        for budget in BUDGETS:
            line = ["%.0f" % height, budget]
            for family in families:
                mine = [[row for row in group if row["kind"] == "swept" and family_of(row) == family] for group in here]
                best = [row for row in (front_rule.within(group, budget) for group in mine) if row]
                middle = lambda name: statistics.median(row[name] for row in best)
                line.append("%s px, %s kB (%d of %d)" % (px(middle("err_px_p95")), kb(middle("bytes")), len(best), len(here)) if best else "–")
            lines.append(line)
    return table(["#metres up", "#triangles"] + ["%s, %s" % (kind, "on" if panorama else "off") for kind, panorama in families], lines)


def settings_table(rows):
    """Every setting over all grounds and links at one height: does one value suit all?"""
    together = front_rule.points(front_rule.judged(rows))
    found = {}
    for group in together.values():
        swept = [row for row in group if row["kind"] == "swept"]
        for row in group:
            found.setdefault((row["kind"], row["setting"]), []).append((row, bool(front_rule.dominators(row, swept))))
    lines = []
    for (kind, setting), pairs in found.items():
        column = lambda name: [row[name] for row, _ in pairs]
        triangles, errors = column("triangles"), column("err_px_p95")
        lines.append(["**%s**" % setting if kind == "named" else setting, "%d of %d" % (sum(beaten for _, beaten in pairs), len(pairs)),
                      "%.0f" % statistics.median(triangles), "%.0f" % max(triangles), px(statistics.median(errors)), px(max(errors)),
                      kb(statistics.median(column("bytes"))), kb(max(column("bytes")))])
    return table(["setting", "#dominated at", "#triangles", "#most", "#p95 px", "#most", "#kB", "#most"], lines)


def point_table(together):
    """The front's members, and named settings among them with what dominates them."""
    swept = [row for row in together if row["kind"] == "swept"]
    members = front_rule.front(swept)
    shown = sorted(members + [row for row in together if row["kind"] == "named"], key=lambda row: (row["triangles"], row["bytes"], row["setting"]))
    lines = []
    for row in shown:
        by = front_rule.dominators(row, swept) if row["kind"] == "named" else []
        lines.append(["**%s**" % row["setting"] if row["kind"] == "named" else row["setting"], "%.0f" % row["triangles"], kb(row["bytes"]),
                      px(row["err_px_p95"]), px(row["skyline_px_rms"]), "%.2f" % row["undrawn_px_percent"], "%.1f" % row["panorama_px_percent"],
                      "–" if row["diff_mean"] is None else "%.2f" % row["diff_mean"], "–" if row["ssim"] is None else "%.3f" % row["ssim"],
                      "%s, %.2f" % (by[0]["setting"], front_rule.factor(by[0], row)) if by else "–"])
    return table(["setting", "#triangles", "#kB", "#p95 px", "#skyline px", "#undrawn %", "#panorama %", "#diff", "#ssim", "dominated by"], lines)


def write(out, rows, target, window_s, refused):
    main = [row for row in rows if row["course"] == "front"]
    named = list(dict.fromkeys(row["setting"] for row in main if row["kind"] == "named"))
    sums, each = balance_tables(main)
    heights = sorted({row["height_m"] for row in main})
    plots = [(link, what, front_plot.write(out, link, what, [row for row in front_rule.judged(main) if row["link"] == link], target))
             for link in dict.fromkeys(row["link"] for row in main) for what in ("triangles", "bytes")]
    text = [
        "# Operating points and the front\n",
        "`make front`: %d flights over %s, at %s m above ground, over %s. `front.csv` has a row for each.\n" % (
            len(rows), ", ".join(dict.fromkeys(row["ground"] for row in main)), ", ".join("%.0f" % h for h in heights),
            ", ".join(dict.fromkeys(row["link"] for row in main))),
        "Triangles and error (p95, px) are means over the flight after settling; bytes are all that came since its start. A named setting is "
        "*dominated* at a point (ground, height, link) where a swept one has 10 % fewer triangles, 10 % fewer bytes and 10 % less error at once; "
        "the factor says how many times as much it has in the measure in which it is worse least. Settings: quality (C:DEPTH, depth 0 has all "
        "levels, or px:E), panorama on or off.\n",
        *["The program does not know %s: left out.\n" % ", ".join(refused) for _ in refused[:1]],
        "## Named settings and the front\n", standing_table(main),
        "## A stranger's ground, no options\n",
        "%s, %s, %d km/h: at most %g px (p95) within %d triangles, as means after settling. " % (
            target["setting"], target["link"], target["speed"], target["err_px_p95"], target["triangles"]) + target_table(rows, target),
        "## The balance and the best fixed setting\n",
        "In each %d s after settling: the swept setting with the least error among those with as many triangles and bytes since the start "
        "(at most 5 %% more). A flight needs its budget where some swept setting draws more than it and has a fifth less error.\n" % window_s, sums,
        "<details><summary>each flight</summary>\n", each, "</details>\n",
        "## Plots\n",
        "Filled points are on the front of triangles, bytes and error; the line joins the least error for each number on the axis. "
        "Diamonds are named settings. Dashed: %d triangles, %g px.\n" % (target["triangles"], target["err_px_p95"]),
        *["### %s, error against %s\n\n![error against %s over %s](%s)\n" % (link, what, what, link, name) for link, what, name in plots],
        "## The least error within a frame's triangles\n", within_table(main),
        "By measure, with panoramas (on) and without (off); depth: C with a limit of depth. Medians over grounds and links.\n", families_table(main),
        "## Settings over all grounds and links\n", "Medians and the most.\n",
        *["### %.0f m\n\n%s" % (height, settings_table([row for row in main if row["height_m"] == height])) for height in heights],
        "## The front at each point\n", "Named settings: %s.\n" % ", ".join("**%s**" % name for name in named),
        *["### %s\n\n%s" % (at(together[0]), point_table(together)) for together in front_rule.points(front_rule.judged(main)).values()]]
    with open(out + "/front.md", "w", encoding="utf-8") as file:
        file.write("\n".join(text))
