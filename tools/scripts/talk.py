#!/usr/bin/env python3
"""What the talk between client and server costs: round trips until the picture is right, and bytes that bring nothing to draw.

    tools/scripts/talk.py BIN OUT [--links NAME,...] [--heights M,...] [--events start,cut,leap,turn] [--seeds N] [--jobs N] PACK...

Writes two tables to OUT/talk.md. The first: for each ground, height and link how long it takes until 95 % of the pixels are at most 2 pixels
off, after the start, a cut of 20 s in which the
viewer leaps, a leap and a turn; the bytes that came until then; and the bound, `2 round trips + bytes / rate + 1 s`, a
round trip as the link drew it: the means of how long packets were under way up and down. Medians over the seeds. The second: of 300 s at
150 km/h what requests, headers and all that is no payload take; packets, and the bytes of their IP and TCP headers."""
import argparse, concurrent.futures, csv, json, os, statistics, subprocess

FAR_S = 30  # a leap, a cut or a turn comes then
LOOK_S = 30  # so long it may take
AWAY_S = 20  # so long the link is away after a cut
PIXELS = 2
HEADER_BYTES = 40  # of sim_link_profiles.c
EVENTS = {"start": [], "cut": ["cut", "teleport=0.65,0.3"], "leap": ["teleport=0.65,0.3"], "turn": ["turn=150"]}


def rate_of(given, link):
    """Bytes a second down, as farfield-link tells them; 0: no limit."""
    table = subprocess.run([os.path.join(given.bin, "farfield-link"), "--list"], check=True, capture_output=True, text=True).stdout
    return next(float(line.split()[1]) for line in table.splitlines() if line.split()[0] == link)


def fly(given, pack, link, height, seed, *more):
    path = os.path.join(given.out, f"{os.getpid()}-{os.path.basename(pack)}-{link.split(',')[0]}-{height}-{seed}-{abs(hash(more))}.csv")
    command = [os.path.join(given.bin, "farfield-fly"), "--pack", pack, "--link", link, "--height", str(height), "--seed", str(seed), "--settle", "0",
               "--backend", "none", "--fps", "8", "--check", "off", "--csv", path, "--json", *more, *given.more]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    with open(path) as file:
        rows = list(csv.DictReader(file))
    os.remove(path)
    return json.loads(told), rows


def right_after(rows, from_s):
    """The first row from then on whose picture is right, and the last one before then."""
    before = [row for row in rows if float(row["t_s"]) < from_s]
    for row in rows:
        if float(row["t_s"]) >= from_s and float(row["nodes_drawn"]) > 0 and float(row["err_px_p95"]) <= PIXELS:
            return row, before[-1] if before else None
    return None, before[-1] if before else None


def back_since(rows):
    """When the link was up again after it was lost."""
    lost = False
    for row in rows:
        lost |= float(row["t_s"]) > FAR_S and float(row["link_up"]) == 0
        if lost and float(row["link_up"]) == 1:
            return float(row["t_s"])
    return FAR_S


def settle(given, pack, link, height, seed, event):
    """Seconds, round trips, bytes, the bound in seconds, bytes of views that nothing drawn ever needed, and of all views."""
    at = 0 if event == "start" else FAR_S
    options = ["--audit", "on", "--audit-step", "12", "--sample", "0.25", "--seconds", str(at + LOOK_S + (AWAY_S if event == "cut" else 0)), "--speed", "150"]
    for what in EVENTS[event]:
        options += ["--event", f"{at}:{what}"]
    if event == "cut":
        options += ["--event", f"{at - 0.1}:link={link},connect_ms={AWAY_S}000"]
    _, rows = fly(given, pack, link, height, seed, *options)
    from_s = back_since(rows) if event == "cut" else at
    row, before = right_after(rows, from_s + (0 if event == "start" else 0.05))
    if not row:
        return None
    less = lambda name: float(row[name]) - (float(before[name]) if before else 0)
    trip_s = float(row["delay_up_s"]) + float(row["delay_down_s"])
    seconds = float(row["t_s"]) - from_s
    bound = 2 * trip_s + less("bytes_down") / given.rate[link] + 1
    gained = lambda name: float(rows[-1][name]) - (float(before[name]) if before else 0)
    return seconds, less("round_trips"), less("bytes_down"), bound, gained("wasted_views"), gained("bytes_views")


def steady(given, pack, link, height):
    told, _ = fly(given, pack, link, height, 1, "--seconds", "300", "--speed", "150")
    down, up = told["bytes_down_all"], told["bytes_up_all"]
    share = lambda a, b: a / b if b else 0
    return (down / 1000, share(told["node_request_bytes"], told["node_requests"]), share(told["node_header_bytes"], told["node_answers"]),
            100 * share(told["bytes_framing"], down), 100 * share(up, down), told["packets_down"], told["packets_up"],
            HEADER_BYTES * (told["packets_down"] + told["packets_up"]) / 1000)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("packs", nargs="+", metavar="PACK")
    parser.add_argument("--links", default="gprs,edge,umts,ltem,nbiot,iridium")
    parser.add_argument("--heights", default="100,2000")
    parser.add_argument("--events", default="start,cut,leap,turn")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--more", default="", help="options for farfield-fly, between commas")
    given = parser.parse_args()
    given.more = [word for word in given.more.split(",") if word]
    os.makedirs(given.out, exist_ok=True)
    links = given.links.split(",")
    given.rate = {link: rate_of(given, link) for link in links}
    cases = [(pack, float(height), link) for pack in given.packs for height in given.heights.split(",") for link in links]
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool, open(os.path.join(given.out, "talk.md"), "w") as table:
        def say(line):
            print(line, flush=True)
            print(line, file=table, flush=True)
        if given.events:
            say("| ground | height, m | link | after | seconds (bound) | round trips | kB | views of no use, % | within the bound |\n" + "|---" * 9 + "|")
        jobs = [(case, event, [pool.submit(settle, given, case[0], case[2], case[1], seed + 1, event)
                               for seed in range(10 if case[2] == "nbiot" and event == "start" else given.seeds)])
                for case in cases for event in given.events.split(",") if event]
        for (pack, height, link), event, runs in jobs:
            got = [run.result() for run in runs]
            fine = [g for g in got if g]
            if not fine:
                say(f"| {os.path.basename(pack)[:-4]} | {height:g} | {link} | {event} | never | | | | 0 of {len(got)} |")
                continue
            m = [statistics.median(g[i] for g in fine) for i in range(4)]
            waste, views = sum(g[4] for g in fine), sum(g[5] for g in fine)
            within = sum(g[0] <= g[3] for g in fine)
            say(f"| {os.path.basename(pack)[:-4]} | {height:g} | {link} | {event} | {m[0]:.1f} ({m[3]:.1f}) | {m[1]:g} | {m[2] / 1000:.1f} | "
                f"{f'{100 * waste / views:.1f}' if views > 2000 * len(fine) else ''} | {within} of {len(got)} |")
        say("\n| ground | height, m | link | kB | bytes a request | bytes of a header | framing, % | up, % of down | packets down, up | kB of their headers |\n"
            + "|---" * 10 + "|")
        runs = [(case, pool.submit(steady, given, case[0], case[2], case[1])) for case in cases]
        for (pack, height, link), run in runs:
            g = run.result()
            say(f"| {os.path.basename(pack)[:-4]} | {height:g} | {link} | {g[0]:.1f} | {g[1]:.2f} | {g[2]:.2f} | {g[3]:.2f} | {g[4]:.2f} | "
                f"{g[5]:.0f}, {g[6]:.0f} | {g[7]:.1f} |")


main()
