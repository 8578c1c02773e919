#!/usr/bin/env python3
"""hills.py SIZE[:KIND] FILE [SIZE[:KIND] FILE]...: small ground of SIZE x SIZE samples as raw 16-bit little-endian heights. KIND: hills,
the ground that script tests bake where they ask for nothing special; fractal, rough at every size; plateaus, level and steep by turns; waves,
the higher the longer they are, up to twice 1024 samples."""
import math
import random
import struct
import sys


def hills(x, y):
    return int(700 + 350 * math.sin(x / 23) * math.cos(y / 31) + 120 * math.sin(x / 5 + y / 9) + 40 * math.sin(x * 1.7) * math.sin(y * 1.3))


def noise(x, y, edge, seed):
    """Smooth noise of -1 to 1, a new value every `edge` samples."""
    def corner(i, j):
        if (i, j, seed) not in known:
            known[i, j, seed] = random.Random(seed * 1000003 + i * 1009 + j).uniform(-1, 1)
        return known[i, j, seed]
    i, j = int(x // edge), int(y // edge)
    u, v = x / edge - i, y / edge - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    return ((corner(i, j) * (1 - u) + corner(i + 1, j) * u) * (1 - v) + (corner(i, j + 1) * (1 - u) + corner(i + 1, j + 1) * u) * v)


known = {}  # corners of the noise


def fractal(x, y):
    return int(1500 + sum(8 * edge * noise(x, y, edge, edge) for edge in (2, 4, 8, 16, 32, 64)))


def plateaus(x, y):
    height = 900 + 500 * noise(x, y, 48, 1) + 150 * noise(x, y, 12, 2)
    step = 200 * math.floor(height / 200)
    return int(step + 200 * min(1, max(0, (height - step - 150) / 50)))


def waves(x, y):
    return int(9000 + sum(2.5 * length * math.sin(x / length + o) * math.cos(y / length + 2 * o) for o, length in enumerate(lengths)))


lengths = [2 ** (o / 2) for o in range(19)]

for size, path in zip(sys.argv[1::2], sys.argv[2::2]):
    size, _, kind = size.partition(":")
    ground = {"": hills, "hills": hills, "fractal": fractal, "plateaus": plateaus, "waves": waves}[kind]
    with open(path, "wb") as out:
        for y in range(int(size)):
            out.write(struct.pack("<%sH" % size, *(ground(x, y) for x in range(int(size)))))
