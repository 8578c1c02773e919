#!/usr/bin/env python3
"""options.py: every option of every program, tried from what --help says of it: missing and empty values, words and numbers it must not
take, in one line on stderr and with exit status 2. Options that several programs have mean the same in all; each option's field is read
somewhere. Prints TAP lines."""
import glob
import os
import re
import subprocess
import sys

os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
BIN = os.environ.get("BIN", "build/bin")
PROGRAMS = "bake export fly handheld info link merge report server train view".split()
FREE = "LAYER NAME=IMAGE FILE DIR PACK PACKS TEXT TITLE TABLE IMAGE OUT.ffp KIND|FILE".split()  # values that may be any text
ALIKE = "quality balance memory size fov at to".split()                        # and links, below: one range in all programs
failures = 0


def result(wrong, what):
    """`wrong`: what is wrong, one a line; nothing: it holds."""
    global failures
    failures += bool(wrong)
    print("%sok - %s" % ("not " if wrong else "", what), flush=True)
    for line in wrong:
        print("# " + line)


def run(program, *arguments):
    return subprocess.run([os.path.join(BIN, "farfield-" + program), *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)


def refusal(program, arguments, *words):
    """None, or why these arguments are not refused as they should be."""
    done = run(program, *arguments)
    lines = done.stderr.splitlines()
    if done.returncode != 2 or done.stdout or len(lines) != 1 or not lines[0].startswith("farfield-%s: " % program):
        return "%s: exit %d, %r" % (" ".join([program, *arguments]), done.returncode, done.stderr[:300])
    missing = [word for word in words if word not in lines[0]]
    return "%s: %r does not say %s" % (" ".join([program, *arguments]), lines[0], missing) if missing else None


class Option:
    """One block of --help: name, what its value is called (None: it has none), the words in its last brackets."""

    def __init__(self, block):
        head = re.match(r"  (?:-\w, )?--([\w-]+)(?: (\S+))?", block)
        self.name, self.value = head.group(1), head.group(2)
        brackets = re.search(r" \(((?:[^()]|\([^()]*\))*)\)$", re.sub(r"\s+", " ", block.strip()))
        self.range = re.sub(r"(; )?(default .*|may be repeated.*)$", "", brackets.group(1)) if brackets else ""
        limits = re.search(r"(?:^|, )([\d.e+-]+) to ([\d.e+-]+)( \w+)?$", self.range)
        self.low, self.high = limits.groups()[:2] if limits and self.value else (None, None)


def options_of(text):
    blocks = re.findall(r"^  (?:-\w, )?--.*(?:\n {20,}\S.*)*", text, re.M)
    return [Option(block) for block in blocks if not re.match(r"  --(help|version)\b", block)]


def try_program(program, options):
    valued = [o for o in options if o.value]
    limited = [o for o in valued if o.high]
    each = lambda tries: [why for why in tries if why]
    result(each([refusal(program, ["--nonsense"], "--nonsense")]), "%s: an unknown option" % program)
    result(each(refusal(program, ["--" + o.name], "--" + o.name, o.value) for o in valued), "%s: a missing value, %d options" % (program, len(valued)))
    result(each(refusal(program, ["--%s=" % o.name], "--" + o.name) for o in valued), "%s: an empty value" % program)
    picky = [o for o in valued if o.value not in FREE]
    result(each(refusal(program, ["--" + o.name, "?!"], "--%s: ?! is not" % o.name, o.range) for o in picky), "%s: not one of its values, %d options" % (program, len(picky)))
    outside = [(o, "%.12g" % (float(o.high) + 1)) for o in limited] + [(o, "%.12g" % (float(o.low) - 1)) for o in limited]
    result(each(refusal(program, ["--" + o.name, far], "--%s: %s is not" % (o.name, far), o.low, o.high) for o, far in outside),
           "%s: out of range, %d options" % (program, len(limited)))
    result(each(refusal(program, ["--%s=1" % o.name], "--%s: takes no value" % o.name) for o in options if not o.value), "%s: a value too many" % program)


def try_help(program, done):
    lines = done.stdout.splitlines()
    wrong = ["exit %d" % done.returncode] * (done.returncode != 0) + done.stderr.splitlines()
    wrong += [line for line in lines if len(line) > 100]
    wrong += ["no line %r" % line for line in ("Exit status: 0 done, 1 failed while working, 2 wrong usage.",) if line not in lines]
    wrong += ["no usage"] * (not lines[0].startswith("Usage: farfield-%s " % program))
    result(wrong, "%s: --help, at most 100 columns" % program)
    said = run(program, "--version")
    result([said.stdout + said.stderr] * (said.returncode != 0 or not re.fullmatch(r"farfield-%s \d+\.\d+\.\d+\n" % program, said.stdout)),
           "%s: --version" % program)


def try_alike(options):
    for name in ALIKE:
        ranges = {program: o.range for program in PROGRAMS for o in options[program] if o.name == name}
        result(["%s: %s" % pair for pair in ranges.items()] * (len(set(ranges.values())) != 1 or len(ranges) < 2),
               "--%s means the same in %s" % (name, ", ".join(ranges)))
    links = [(program, o) for program in PROGRAMS for o in options[program] if o.value == "SPEC" and o.name in ("link", "profile")]
    names = [line.split()[0] for line in run("link", "--list").stdout.splitlines()[1:]]
    result(["%s --%s: %s" % (program, o.name, name) for program, o in links for name in names if not re.search(r"\b%s\b" % name, o.range)],
           "--help of %s names %d links" % (", ".join(program for program, _ in links), len(names)))
    wrong = [refusal(program, ["--memory", "16"], "--memory: 16 is not a number of bytes") for program in ("fly", "view", "handheld")]
    for program, arguments in ("fly", ["--pack", "none.ffp"]), ("view", ["none.ffp"]), ("handheld", ["--pack", "none.ffp"]):
        done = run(program, "--memory", "600K", "--memory", "0.75M", "--quality", "px:0.5", "--balance", "5000,3000", *arguments)
        wrong += ["%s: exit %d, %r" % (program, done.returncode, done.stderr)] * (done.returncode != 1 or "none.ffp" not in done.stderr)
    result([why for why in wrong if why], "fly, view and handheld take the same words; what fails while working ends with 1")
    result([] if "seed 4," in run("fly", "--pack", "none.ffp", "--seed", "3", "--seed", "4").stderr else ["not 4"], "the last value given counts")


# ---- an option that nobody handles: its row declares a field, which code of the program's room must read ----
def fields_of(text, shared):
    """Fields of the rows in `text`, with those of the lists of `shared` that it takes in."""
    fields = re.findall(r"\b(?:OPTION|HEAD)\(\w+, (\w+),", text)
    for name in re.findall(r"^    (SIM_\w+)\(OPTION", text, re.M):
        fields += fields_of(shared[name], {})
    return fields + ["show"] * ("sys_bits show" in text)


def unread(path, text, shared):
    room = os.path.dirname(path)
    code = "".join(open(name).read() for name in glob.glob(room + "/**/*.[ch]", recursive=True))
    code += "".join(body for name, body in shared.items() if re.search(r"= %s\(" % name, code))
    return ["%s: nobody reads %s" % (path, field) for field in fields_of(text, shared) if not re.search(r"(\.|->)%s\b" % field, code)]


def try_fields():
    lists = [path for path in glob.glob("*/**/*.[ch]", recursive=True) if not path.startswith(("build/", "tests/", "platform/")) and "SYS_FIELD" in open(path).read()]
    shared = {}
    for path in ("sim/options/sim_client_options.h", "sim/options/sim_where.h", "sim/link/sim_link_option.h"):
        for name, body in re.findall(r"#define (SIM_\w+)\(OPTION[^\n]*\\\n((?:.*\\\n)*.*\n)", open(path).read()):
            shared[name] = body
        for name, body in re.findall(r"#define (SIM_\w+)\(options\)[^\n]*\\\n((?:.*\\\n)*.*\n)", open(path).read()):
            shared[name] = body # what makes one value of several options
    result(["%d programs have a list: %s" % (len(lists), lists)] * (len(lists) != len(PROGRAMS)), "each program has its list of options")
    wrong, count = [], 0
    for path in lists:
        text = open(path).read()
        wrong += unread(path, text, shared)
        count += len(fields_of(text, shared))
    result(wrong, "every option is read by its program (%d)" % count)
    planted = 'OPTION(sys_flag, planted_field, "planted", NULL, NULL, SYS_ANY, "")'
    result([] if unread(lists[0], planted, shared) else ["not found"], "an option that nobody reads is found")


def main():
    options = {}
    for program in PROGRAMS:
        done = run(program, "--help")
        options[program] = options_of(done.stdout)
        try_help(program, done)
        try_program(program, options[program])
    try_alike(options)
    try_fields()
    readme = open("README.md").read()
    result([] if "0 done, 1 failed while working, 2 wrong usage" in readme else ["not in README.md"], "README.md tells the exit codes")
    return failures > 0


sys.exit(main())
