#!/usr/bin/env python3
"""whole_jpeg.py PACK OUT: the texture of a pack's first root as a whole JPEG, headers and tables put back (protocol/SPEC.md, 4 and 5.2)."""
import os
import re
import struct
import sys

ZIGZAG = sorted(range(64), key=lambda i: (i // 8 + i % 8, i % 8 if (i // 8 + i % 8) % 2 == 0 else i // 8))


def annex_k():
    """Quantisation tables of Y and chroma; Huffman tables (lengths, values) DC Y, DC chroma, AC Y, AC chroma."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../platform/posix/jpeg_tables.c")
    text = re.sub(r"/\*.*?\*/", "", open(path).read(), flags=re.S)
    lists = [[int(n, 0) for n in part.split(",") if n.strip()] for part in re.findall(r"\{([^{}]*[0-9A-F]\s*)\}", text)]
    lists = [part for part in lists if len(part) in (12, 16, 64, 162)]
    return lists[:2], [(lists[2 + 2 * i], lists[3 + 2 * i]) for i in range(4)]


def first_texture(pack):
    """Side and payload."""
    side = 1 << pack[12 + 4]
    for i in range(struct.unpack_from("<I", pack, 80)[0]):
        kind, level, bits, index, data = struct.unpack_from("<4s2xB13xB3xQQ", pack, 84 + 48 * i)
        if kind == b"IMAG" and level == 0:
            roots = struct.unpack_from("<I", pack, 84 + 16)[0]  # the first section's records: places of this one
            lengths = index + (roots + 255) // 256 * 36 + 8
            length = struct.unpack_from("<I", pack, lengths)[0] & (1 << bits) - 1
            return side, pack[data + 2:data + 2 + length]
    sys.exit("no textures")


def segment(marker, body):
    return struct.pack(">BBH", 0xFF, marker, len(body) + 2) + body


def whole(side, bare):
    while bare[0] > 128:  # bytes that say which children have no image may stand before
        bare = bare[1:]
    quality, (steps, codes) = bare[0], annex_k()
    percent = 5000 // quality if quality < 50 else 200 - 2 * quality
    jpeg = b"\xFF\xD8"
    for number, table in enumerate(steps):
        jpeg += segment(0xDB, bytes([number] + [min(255, max(1, (table[i] * percent + 50) // 100)) for i in ZIGZAG]))
    jpeg += segment(0xC0, struct.pack(">BHHB", 8, side, side, 3) + bytes([1, 0x22, 0, 2, 0x11, 1, 3, 0x11, 1]))
    for (lengths, values), number in zip(codes, (0x00, 0x01, 0x10, 0x11)):
        jpeg += segment(0xC4, bytes([number] + lengths + values))
    return jpeg + segment(0xDA, bytes([3, 1, 0, 2, 0x11, 3, 0x11, 0, 63, 0])) + bare[1:] + b"\xFF\xD9"


open(sys.argv[2], "wb").write(whole(*first_texture(open(sys.argv[1], "rb").read())))
