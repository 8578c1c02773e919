#!/usr/bin/env python3
"""hills.py SIZE FILE [SIZE FILE]...: small hills of SIZE x SIZE samples as raw 16-bit little-endian heights. The ground
that script tests bake where they ask for nothing special."""
import math
import struct
import sys


def hills(x, y):
    return int(700 + 350 * math.sin(x / 23) * math.cos(y / 31) + 120 * math.sin(x / 5 + y / 9) + 40 * math.sin(x * 1.7) * math.sin(y * 1.3))


for size, path in zip(sys.argv[1::2], sys.argv[2::2]):
    with open(path, "wb") as out:
        for y in range(int(size)):
            out.write(struct.pack("<%sH" % size, *(hills(x, y) for x in range(int(size)))))
