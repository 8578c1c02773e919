"""Other codecs of heights, as Debian packages have them: what bench_codec.py sets beside ours. A peer packs a grid of 16-bit heights so that
none is off by more than a number of steps. JPEG-LS and LERC keep such a bound themselves; JPEG 2000 and JPEG XL have none, so heights are
quantised with twice the bound and one, and those numbers are coded without loss. What is packed is a bare stream, without a file around it."""
import array
import ctypes
import os
import shutil
import subprocess
import sys
import threading

NEAR_MAX = 255  # the most that a JPEG-LS stream can say
BITS_MIN = 9  # of what CharLS reads from 16 bits
LERC_USHORT = 3
JXL_EFFORT = 7


class Grid:
    """Heights, 0 and more, row by row."""

    def __init__(self, side, heights):
        self.width, self.height = side
        self.heights = heights

    def crop(self, x, y, width, height):
        rows = (self.heights[(y + j) * self.width + x:(y + j) * self.width + x + width] for j in range(height))
        return Grid((width, height), array.array("H", b"".join(row.tobytes() for row in rows)))

    def quantised(self, steps):
        quantum = 2 * steps + 1
        return Grid((self.width, self.height), array.array("H", ((h + steps) // quantum for h in self.heights)))

    def bits(self):
        return max(max(self.heights).bit_length(), 8)


    def near(self, steps):
        """What is made of these heights when they were quantised, and came through without loss."""
        quantum = 2 * steps + 1
        return array.array("H", (min(h * quantum, 65535) for h in self.quantised(steps).heights))


class JpegLs:
    name, package, library = "JPEG-LS", "libcharls2", "libcharls.so.2"

    class Frame(ctypes.Structure):
        _fields_ = [("width", ctypes.c_uint32), ("height", ctypes.c_uint32), ("bits", ctypes.c_int32), ("components", ctypes.c_int32)]

    def __init__(self):
        self.lib = ctypes.CDLL(self.library)
        self.lib.charls_jpegls_encoder_create.restype = self.lib.charls_jpegls_decoder_create.restype = ctypes.c_void_p

    def quantises(self, steps):
        return steps > NEAR_MAX  # as those do that have no bound at all

    def pack(self, grid, steps):
        lib, coder = self.lib, ctypes.c_void_p(self.lib.charls_jpegls_encoder_create())
        if self.quantises(steps):
            grid, steps = grid.quantised(steps), 0
        raw, size = grid.heights.tobytes(), ctypes.c_size_t()
        out = ctypes.create_string_buffer(2 * len(raw) + 1024)
        failed = (lib.charls_jpegls_encoder_set_frame_info(coder, ctypes.byref(self.Frame(grid.width, grid.height, max(grid.bits(), BITS_MIN), 1)))
                  or lib.charls_jpegls_encoder_set_near_lossless(coder, ctypes.c_int32(steps))
                  or lib.charls_jpegls_encoder_set_destination_buffer(coder, out, ctypes.c_size_t(len(out)))
                  or lib.charls_jpegls_encoder_encode_from_buffer(coder, raw, ctypes.c_size_t(len(raw)), ctypes.c_uint32(0))
                  or lib.charls_jpegls_encoder_get_bytes_written(coder, ctypes.byref(size)))
        lib.charls_jpegls_encoder_destroy(coder)
        if failed:
            sys.exit("JPEG-LS: error %d" % failed)
        return out.raw[:size.value]

    def unpack(self, packed, grid, steps):
        lib, coder = self.lib, ctypes.c_void_p(self.lib.charls_jpegls_decoder_create())
        out = ctypes.create_string_buffer(2 * grid.width * grid.height)
        failed = (lib.charls_jpegls_decoder_set_source_buffer(coder, packed, ctypes.c_size_t(len(packed)))
                  or lib.charls_jpegls_decoder_read_header(coder)
                  or lib.charls_jpegls_decoder_decode_to_buffer(coder, out, ctypes.c_size_t(len(out)), ctypes.c_uint32(0)))
        lib.charls_jpegls_decoder_destroy(coder)
        if failed:
            sys.exit("JPEG-LS: error %d" % failed)
        if self.quantises(steps):
            return grid.near(steps)
        return array.array("H", out.raw)


class Lerc:
    name, package, library = "LERC", "liblerc4", "libLerc.so.4"

    def __init__(self):
        self.lib = ctypes.CDLL(self.library)

    def quantises(self, steps):
        return False

    def pack(self, grid, steps):
        raw, size = grid.heights.tobytes(), ctypes.c_uint()
        out = ctypes.create_string_buffer(2 * len(raw) + 1024)
        failed = self.lib.lerc_encode(raw, LERC_USHORT, 1, grid.width, grid.height, 1, 0, None, ctypes.c_double(max(steps, 0.5)), out, len(out),
                                      ctypes.byref(size))
        if failed:
            sys.exit("LERC: error %d" % failed)
        return out.raw[:size.value]

    def unpack(self, packed, grid, steps):
        out = ctypes.create_string_buffer(2 * grid.width * grid.height)
        if self.lib.lerc_decode(packed, len(packed), 0, None, 1, grid.width, grid.height, 1, LERC_USHORT, out):
            sys.exit("LERC: cannot be decoded")
        return array.array("H", out.raw)


class Program:
    """A peer that is a program: it reads a picture of quantised heights and writes a file."""

    def __init__(self, scratch):
        if not shutil.which(self.program):
            raise OSError("no %s" % self.program)
        self.scratch = scratch

    def quantises(self, steps):
        return True

    def pack(self, grid, steps):
        grid = grid.quantised(steps)
        path = os.path.join(self.scratch, "peer.%d" % threading.get_ident())
        big = array.array("H", grid.heights)
        if sys.byteorder == "little":
            big.byteswap()
        with open(path + ".pgm", "wb") as file:
            file.write(b"P5\n%d %d\n%d\n" % (grid.width, grid.height, (1 << grid.bits()) - 1 if self.odd_depths else 65535))
            file.write(big.tobytes() if grid.bits() > 8 or not self.odd_depths else bytes(grid.heights.tolist()))
        done = subprocess.run([self.program, *self.arguments(grid, path)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode:
            sys.exit("%s: %s" % (self.program, done.stdout.strip().splitlines()[-1]))
        with open(path + self.ending, "rb") as file:
            packed = file.read()
        for ending in (".pgm", self.ending):
            os.remove(path + ending)
        return packed

    def unpack(self, packed, grid, steps):
        return grid.near(steps)  # without loss: what is lost is lost beforehand


class Jpeg2000(Program):
    name, package, program, ending = "JPEG 2000", "libopenjp2-tools", "opj_compress", ".j2k"
    odd_depths = True

    def arguments(self, grid, path):
        levels = min(6, (min(grid.width, grid.height) - 1).bit_length())
        return ["-i", path + ".pgm", "-o", path + self.ending, "-n", str(levels)]


class JpegXl(Program):
    name, package, program, ending = "JPEG XL", "libjxl-tools", "cjxl", ".jxl"
    odd_depths = False  # cjxl 0.7 drops the upper bits of pictures of 13, say

    def arguments(self, grid, path):
        return ["-d", "0", "-e", str(JXL_EFFORT), "--num_threads=0", "--quiet", path + ".pgm", path + self.ending]


def installed(scratch):
    """Peers that are there, and lines about those that are not."""
    peers, missing = [], []
    for kind in (JpegLs, Lerc, Jpeg2000, JpegXl):
        try:
            peers.append(kind(scratch) if issubclass(kind, Program) else kind())
        except OSError:
            missing.append("%s is left out: the package %s is not installed" % (kind.name, kind.package))
    return peers, missing
