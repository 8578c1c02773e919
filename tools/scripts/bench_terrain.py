#!/usr/bin/env python3
"""bench_terrain.py DIR: the terrains that farfield-handheld is measured over, from integers alone: the same bytes everywhere.

DIR/ground.raw: 2049 x 2049 heights of 16 bits, decimetres, 50 m apart: a mountain range from six octaves of value noise.
DIR/ground.ppm: its image, one pixel a sample: rock, forest, meadow and water by height and slope, with grain.
DIR/mountains.raw: 1025 x 1025 heights of 16 bits, decimetres, 90 m apart: sharp ridges and basins between them, from eight octaves; no image."""
import array
import sys

N = 2049
MOUNTAINS_N = 1025


def hash32(x, y, seed):
    h = (x * 374761393 + y * 668265263 + seed * 2246822519) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    return h ^ (h >> 16)


def octave(n, step, seed, height):
    """n x n values 0..height: noise on a grid of `step` cells, smooth in between (Q10 weights)."""
    cells = n // step + 2
    knot = [[hash32(x, y, seed) & 1023 for x in range(cells)] for y in range(cells)]
    weight = [((i * 1024 // step) ** 2 * (3 * 1024 - 2 * (i * 1024 // step))) >> 20 for i in range(step)]
    rows = []
    for y in range(n):
        j, v = divmod(y, step)
        wy = weight[v]
        column = [(a << 10) + (b - a) * wy for a, b in zip(knot[j], knot[j + 1])]
        row = array.array("i", bytes(4 * n))
        for i in range(cells - 1):
            a, d, base = column[i], column[i + 1] - column[i], i * step
            for u in range(min(step, n - base)):
                row[base + u] = ((a + ((d * weight[u]) >> 10)) * height) >> 20
        rows.append(row)
    return rows


def write_heights(path, ground):
    with open(path, "wb") as f:
        for row in ground:
            little = array.array("H", row)
            if sys.byteorder == "big":
                little.byteswap()
            f.write(little.tobytes())


def mountains(n):
    """Broad basins; upon them ridges, where noise is in the middle of its range, each octave the stronger the higher the ground is."""
    ground = octave(n, 512, 31, 14000)
    for k in range(7):
        step, height = 128 >> k, 12000 * 3 ** k // 5 ** k
        for row, noise in zip(ground, octave(n, step, 32 + k, 2 * height)):
            for x in range(n):
                row[x] += (height - abs(noise[x] - height)) * row[x] >> 14
    return ground


def main(folder):
    octaves = [octave(N, 512 >> k, 11 + k, 18000 >> k if k else 16000) for k in range(6)]
    ground = [[sum(o[y][x] for o in octaves) for x in range(N)] for y in range(N)]
    write_heights(folder + "/ground.raw", ground)
    write_heights(folder + "/mountains.raw", mountains(MOUNTAINS_N))
    with open(folder + "/ground.ppm", "wb") as f:
        f.write(b"P6 %d %d 255\n" % (N, N))
        for y in range(N):
            row, below = ground[y], ground[min(y + 1, N - 1)]
            line = bytearray()
            for x in range(N):
                h, slope = row[x], abs(row[x] - row[min(x + 1, N - 1)]) + abs(row[x] - below[x])
                grain = hash32(x, y, 5) & 31
                if h < 13000:
                    colour = (40 + grain // 4, 70 + grain // 4, 120 + grain // 2)
                elif slope > 420 or h > 27000:
                    colour = (110 + 2 * grain, 100 + 2 * grain, 90 + 2 * grain)
                elif h < 20000:
                    colour = (40 + grain, 80 + grain, 30 + grain)
                else:
                    colour = (100 + grain, 120 + grain, 60 + grain)
                line += bytes(colour)
            f.write(line)


if __name__ == "__main__":
    main(sys.argv[1])
