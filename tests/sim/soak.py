#!/usr/bin/env python3
"""Random flights over random links, packs and options, each from its seed alone, until told to stop.

    tests/sim/soak.py [--first N] [--seeds N] [--jobs N] [--bin DIR] [--work DIR] [--backend KIND] [--memory BYTES] [PACK...]

Seed N always makes the same flight over the same packs. A flight fails when farfield-fly does (a crack, an error, a sanitizer), when it
says anything unexpected, when no ground is seen from a place whose ground is known, when more than one panorama is out at once, when
the healed link of the last 20 seconds is not used to come back to a right picture, or, every fifth seed, when flown again it differs.
Each failure is told with the one command that repeats it."""
import argparse, concurrent.futures, csv, json, math, os, random, struct, subprocess, sys

HEAL_S = 20   # at the end: a good link, full power
KNOWN_S = 15  # after the start, a teleport or panoramas switched on (which give the terrain up) ground may be unknown so long


def known_links(given):
    """Names of all link profiles, as farfield-link tells them."""
    table = subprocess.run([os.path.join(given.bin, "farfield-link"), "--list"], check=True, capture_output=True, text=True).stdout
    return [line.split()[0] for line in table.splitlines()[1:]]


def random_link(rand, links):
    spec = rand.choice(links)
    if rand.random() < 0.3:
        spec += f",stall_every_ms={rand.randrange(2000, 30000)},stall_ms_min=500,stall_ms_max={rand.randrange(1000, 30000)}"
        spec += f",stall_bytes_s={rand.choice((0, 5, 50))}"
    if rand.random() < 0.3:
        spec += f",cut_every_ms={rand.randrange(2000, 30000)}"
    if rand.random() < 0.2:
        spec += f",down.bytes_s={rand.choice((100, 1000, 10000, 100000))}"
    if rand.random() < 0.1:
        spec += f",connect_ms={rand.randrange(1, 20000)}"
    if rand.random() < 0.1:
        spec += f",down.queue_bytes={rand.choice((1, 100, 2000))}"
    return spec


def random_events(rand, links, settle, end):
    events = []
    for _ in range(rand.randrange(0, 9)):
        at = round(rand.uniform(0, end), 1)
        what = rand.choice(("low-battery", "battery-ok", "interruption", "resume", "cut", "panorama-on", "panorama-off", "link", "link",
                            "teleport"))
        if what == "link":
            what += "=" + random_link(rand, links)
        elif what == "teleport":
            what += f"={rand.random():.3f},{rand.random():.3f}"
        events.append((at, what))
    return sorted(events, key=lambda event: event[0])


def random_looks(rand, end):
    """Looks elsewhere at once, at most two."""
    what = lambda: rand.choice((f"turn={rand.randrange(-180, 181)}", f"pitch={rand.randrange(-90, 11)}", f"fov={rand.choice((20, 60, 100))}"))
    return [(round(rand.uniform(0, end), 1), what()) for _ in range(rand.randrange(0, 3))]


def random_flight(seed, packs, given):
    """The arguments of farfield-fly, and the times from which ground may be unknown."""
    rand = random.Random(seed)
    settle, seconds = rand.randrange(0, 16), rand.randrange(10, 61)
    heal = settle + seconds
    events = random_events(rand, given.links, settle, heal)
    args = ["--pack", rand.choice(packs), "--seed", str(seed), "--settle", str(settle), "--seconds", str(seconds + HEAL_S),
            "--link", random_link(rand, given.links), "--path", rand.choice(("diagonal", "diagonal", "circle", "hover", "turn")),
            "--start", f"{rand.random():.3f}", "--speed", str(rand.choice((0, 5, 25, 150, 150, 750, 1000, 3000))),
            "--quality", rand.choice(("low", "medium", "paper-low", "high", "px:0.5", "px:2", "px:8", f"{rand.uniform(0.5, 12):.2f}:{rand.randrange(1, 13)}")),
            "--panorama", rand.choice(("on", "on", "on", "off")), "--face", rand.choice(("64", "128", "256")),
            "--memory", given.memory or rand.choice(("544K", "640K", "1M", "2M", "4M", "8M")),
            "--backend", given.backend or rand.choice(("none", "none", "none", "gl", "gles1", "soft", "soft565")),
            "--size", rand.choice(("240x320", "240x320", "128x128", "320x240", "64x400")), "--fov", str(rand.choice((20, 60, 60, 90))),
            "--fps", str(rand.choice((5, 10, 15))), "--sample", "1", "--audit", "on"]
    view, back_plane = rand.choice((1000, 8000, 30000)), rand.choice((300, 1500, 4000, 7500))
    height = rand.choice([height for height in (2, 30, 100, 100, 500, 2500) if height * 3 <= min(view, back_plane)])
    args += ["--view", str(view), "--back-plane", str(back_plane), "--height", str(height)]
    if rand.random() < 0.2:
        args += ["--plain-arrays"]
    balance = random.Random(f"balance {seed}").choice(("off", "off", "0", "2000", "20000", "3000,1500", "server", "client"))
    if balance != "off":
        args += ["--balance", balance]
    newer = random.Random(f"looks, auto, reserve {seed}")  # what a seed had before stays
    events = sorted(events + random_looks(newer, heal), key=lambda event: event[0])
    if newer.random() < 0.5:
        args[args.index("--panorama") + 1] = "auto"
    if newer.random() < 0.2:
        args += ["--reserve", "off"]
    unknown = [0.0] + [at for at, what in events if what.startswith(("teleport", "panorama-on", "turn", "pitch", "fov"))]
    for what in ("resume", "battery-ok", "link=lan"):
        events.append((heal, what))
    for at, what in events:
        args += ["--event", f"{at}:{what}"]
    return args, unknown, heal


def judge(result, rows, summary, unknown, heal):
    """What is wrong with a flight, or nothing."""
    if "does not fit into --memory" in result.stderr:
        return None
    if result.returncode:
        return f"exit {result.returncode}: {result.stderr.strip().splitlines()[-1:]}"
    said = [line for line in result.stderr.splitlines() if not line.startswith("farfield-fly: seed ")]
    if said:
        return f"said: {said[0]}"
    if summary["crack_frames"]:
        return f"{summary['crack_frames']} frames with cracks"
    if summary["panoramas_in_flight_high"] > 1:
        return f"{summary['panoramas_in_flight_high']} panoramas asked for at once"
    had, healed = False, max(unknown + [heal])
    for row in rows:
        had = had or row["nodes_drawn"] > 0
        waited = row["t_s"] - max(at for at in unknown if at <= row["t_s"])
        known = had and waited > KNOWN_S and row["link_up"] and row["t_s"] > healed + KNOWN_S
        if known and row["nodes_drawn"] == 0 and row["undrawn_px_percent"] > 50:
            return f"no ground at {row['t_s']} s"
    last = rows[-1]
    if not last["link_up"]:
        return "the link is not up again at the end"
    if last["requests"] == 0 or not had and last["undrawn_px_percent"] > 0:
        return "no ground came at all"
    return None


def fly(given, args, name):
    path = os.path.join(given.work, name + ".csv")
    command = [os.path.join(given.bin, "farfield-fly"), *args, "--csv", path, "--json"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=given.timeout)
    if result.returncode:
        return result, [], {}, b""
    with open(path) as file:
        rows = [{k: float(v) for k, v in row.items() if not k.endswith("_hash")} for row in csv.DictReader(file)]
    with open(path, "rb") as file:
        raw = file.read()
    os.remove(path)
    return result, rows, json.loads(result.stdout), raw


def one_seed(given, packs, seed):
    args, unknown, heal = random_flight(seed, packs, given)
    try:
        result, rows, summary, raw = fly(given, args, f"seed-{seed}")
        wrong = judge(result, rows, summary, unknown, heal)
        if not wrong and seed % 5 == 0 and fly(given, args, f"seed-{seed}-again")[3] != raw:
            wrong = "flown again it differs"
    except subprocess.TimeoutExpired:
        wrong, rows, summary = f"still flying after {given.timeout} s", [], {}
    told = "" if wrong else "does not fit into its memory, and says so" if not rows else (f"{summary['frames']} frames, {summary['bytes_down_all']:.0f} bytes, "
                             f"{rows[-1]['reconnects']:.0f} reconnects, {rows[-1]['requests_dropped']:.0f} dropped, "
                             f"err_px_p95 {rows[-1]['err_px_p95']:.1f} at the end")
    return seed, wrong, told, args


def own_packs(given):
    """Small ground of three shapes, baked anew by the programs under test: hills, a narrow strip in small tiles, steep noise."""
    packs = []
    shapes = {"hills": (257, 257, 40, 6, lambda x, y: 700 + 350 * math.sin(x / 23) * math.cos(y / 31) + 120 * math.sin(x / 5 + y / 9)),
              "strip": (513, 65, 20, 4, lambda x, y: 300 + 200 * math.sin(x / 40) + 100 * math.sin(y / 7)),
              "noise": (129, 129, 100, 5, lambda x, y: 1000 + (x * 7919 + y * 104729 + x * y * 31) % 997)}
    for name, (width, height, spacing, tile, shape) in shapes.items():
        raw, pack = os.path.join(given.work, name + ".raw"), os.path.join(given.work, name + ".ffp")
        packs.append(pack)
        with open(raw, "wb") as file:
            file.write(b"".join(struct.pack("<H", int(shape(x, y))) for y in range(height) for x in range(width)))
        subprocess.run([os.path.join(given.bin, "farfield-bake"), raw, "--raw", f"{width}x{height}", "--spacing", str(spacing),
                        "--tile-log2", str(tile), "--quiet", "-o", pack], check=True)
    return packs


def main():
    parse = argparse.ArgumentParser(prog="soak.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("--first", type=int, default=1)
    parse.add_argument("--seeds", type=int, default=100, help="0: until interrupted")
    parse.add_argument("--jobs", type=int, default=os.cpu_count())
    parse.add_argument("--bin", default="build/bin")
    parse.add_argument("--work", default="build/soak")
    parse.add_argument("--backend", help="instead of a random one")
    parse.add_argument("--memory", help="instead of a random one")
    parse.add_argument("--timeout", type=int, default=600, help="seconds a flight may take")
    parse.add_argument("pack", nargs="*", help="instead of three small ones made here")
    given = parse.parse_args()
    given.links = known_links(given)
    os.makedirs(given.work, exist_ok=True)
    os.environ.setdefault("LSAN_OPTIONS", f"suppressions={os.path.dirname(os.path.abspath(__file__))}/../lsan.supp:print_suppressions=0")
    packs, failed, flown, seed = given.pack or own_packs(given), 0, 0, given.first
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        waiting = set()
        try:
            while waiting or not given.seeds or seed < given.first + given.seeds:
                while len(waiting) < given.jobs and (not given.seeds or seed < given.first + given.seeds):
                    waiting.add(pool.submit(one_seed, given, packs, seed))
                    seed += 1
                done, waiting = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
                for number, wrong, told, args in (future.result() for future in done):
                    flown, failed = flown + 1, failed + bool(wrong)
                    print(f"{'not ok' if wrong else 'ok'} - seed {number}: {wrong or told}", flush=True)
                    if wrong:
                        print(f"    {os.path.join(given.bin, 'farfield-fly')} {' '.join(args)} --csv /dev/stdout", flush=True)
        except KeyboardInterrupt:
            print("stopped")
    print(f"{flown} flights, {failed} failed")
    return failed > 0


sys.exit(main())
