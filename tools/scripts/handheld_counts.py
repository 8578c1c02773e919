"""What bench_handheld.py and size_handheld.py share: runs of the cross-built client under the counting plugin (tcg_count.c), and where in
the program an address lies."""
import bisect
import json
import os
import re
import subprocess
import sys

from handheld_rows import is_helper, place_of

NM = "arm-linux-gnueabi-nm"
QEMU = ["qemu-arm", "-cpu", "arm1136"]
PHASES = ("outside", "work", "update", "draw")
LAYOUT = "Linker script and memory map"


def die(text):
    sys.exit("%s: %s" % (os.path.basename(sys.argv[0]), text))


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        die("%s: %s" % (command[0], done.stderr.strip().splitlines()[-1] if done.stderr.strip() else done.returncode))
    return done.stdout


def map_sections(path):
    """(kind, address, bytes, path of the object) of every section linked, from the linker map."""
    text = re.sub(r"\n {16,}0x", " 0x", open(path).read().split(LAYOUT)[1])
    found = re.findall(r"^ \.(text|init|fini|plt|iplt|rodata|data|bss)\S*\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)\s+(\S+)", text, re.M)
    return [(kind, int(at, 16), int(size, 16), obj) for kind, at, size, obj in found if int(size, 16) and int(at, 16)]


class Program:
    """A linked program: object file and function of an address."""

    def __init__(self, path):
        self.path = path
        sections = [s for s in map_sections(path + ".map") if s[0] not in ("rodata", "data", "bss")]
        code = sorted((at, obj) for _, at, _, obj in sections)
        self.starts, self.places = [a for a, _ in code], [place_of(o) for _, o in code]
        names = {}
        for line in run([NM, path]).splitlines():
            word = line.split()
            if len(word) == 3 and word[1] in "tTwWiV" and not word[2].startswith("$"):
                names.setdefault(int(word[0], 16), word[2])
        self.entries = sorted(names)
        self.names = [names[a] for a in self.entries]

        self.helpers = sorted((at, size) for kind, at, size, obj in sections if is_helper(place_of(obj)))

    def is_helper(self, address):
        return is_helper(self.place_of(address))

    def place_of(self, address):
        """The object, as the rows of handheld_rows.py name it."""
        at = bisect.bisect_right(self.starts, address) - 1
        return self.places[at] if at >= 0 else ""

    def function_of(self, address):
        """Its name, and whether `address` is where it begins."""
        place = bisect.bisect_right(self.entries, address) - 1
        return (self.names[place], self.entries[place] == address) if place >= 0 else ("", False)


class Counts:
    """One run under the plugin, see tcg_count.c. figures: what the program said; frames: instructions of each, by phase; blocks:
    (address, instructions of it, executions by phase, instructions by phase of helpers it called); pages: (first, last) touched;
    watched: (number of the area, address of the instruction, bytes read, bytes written)."""

    def __init__(self, plugin, program, arguments, scratch, options=""):
        helpers = "".join(",helper=%x:%d" % at for at in program.helpers)
        self.figures = json.loads(run([*QEMU, "-plugin", "%s,out=%s%s%s" % (plugin, scratch, helpers, options), program.path, *arguments, "--json"]))
        self.frames, self.blocks, self.pages, self.watched = [], [], [], []
        for line in open(scratch):
            word = line.split()
            if word[0] == "frame":
                self.frames.append(dict(zip(PHASES, map(int, word[1:]))))
            elif word[0] == "at":
                self.blocks.append((int(word[1], 16), int(word[2]), dict(zip(PHASES, map(int, word[3:]))), {}))
            elif word[0] == "helped":
                self.blocks[-1][3].update(zip(PHASES, map(int, word[2:])))
            elif word[0] == "watch":
                self.watched.append((int(word[1]), int(word[2], 16), int(word[3]), int(word[4])))
            elif word[0] == "page":
                self.pages.append((int(word[1], 16), int(word[2], 16)))
        os.remove(scratch)

    def costs(self):
        """Of update and draw, a frame each."""
        return [f["update"] + f["draw"] for f in self.frames]
