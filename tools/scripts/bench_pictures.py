#!/usr/bin/env python3
"""make bench-pictures: bytes of images of the ground, level by level, beside JPEGs of the same error, with tables that have not seen the
picture, and ARM instructions a texel: pictures.md in the folder given.

usage: bench_pictures.py BIN OUT --decoder PROGRAM --plugin FILE

  BIN                 the folder with farfield-bake and farfield-train
  --decoder, --plugin decode_images.c built for the handheld, tcg_count.c: counts instructions under qemu-arm
  FARFIELD_DATA=DIR   holds puget-sound-gatech/ and jotunheimen-pair/ (default ../shared/data)
"""
import argparse
import os
import subprocess
import sys
import tempfile

QEMU = ["qemu-arm", "-cpu", "arm1136"]
ERROR = ["--max-error", "20", "--quiet"]  # heights do not matter here
GROUNDS = {
    "Puget Sound": ["puget-sound-gatech/ps_height_1k.png", "--spacing", "160", "--scale", "0.1", "--hscale", "0.1", "--color",
                    "puget-sound-gatech/ps_texture_1k.png"],
    "Jotunheimen": ["jotunheimen-pair/jotunheimen512.bin", "--raw", "512x512", "--spacing", "117.1875", "--hscale", "0.03769", "--color",
                    "jotunheimen-pair/jotunheimen-texture.jpg"],
}


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit("bench_pictures: %s: %s" % (command[0], (done.stderr.strip().splitlines() or ["failed"])[-1]))
    return done.stdout


def instructions(options, pack):
    """Of decoding, and bytes, a texel."""
    counts = pack + ".counts"
    said = dict(line.split() for line in run([*QEMU, "-plugin", "%s,out=%s" % (options.plugin, counts), options.decoder, pack]).splitlines())
    with open(counts, encoding="utf-8") as file:
        words = [line.split() for line in file]
    work = [word for word in words if word[0] == "phase"][0].index("work") + 2
    total = sum(int(word[2]) * int(word[work]) for word in words if word[0] == "at")
    return total / int(said["texels"]), int(said["bytes"]) / int(said["texels"])


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1].split("\n")[0])
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--decoder", required=True)
    parser.add_argument("--plugin", required=True)
    options = parser.parse_args()
    data = os.environ.get("FARFIELD_DATA", "../shared/data")
    text = ["# Images of the ground", "", "Tables are learned of the other picture (`farfield-train --pictures --measure`); RGB PSNR; JPEGs as of version 6.", ""]
    cost = ["## Decoding", "", "ARM instructions a texel, all images of a pack, tables of the format.", "", "| | picture | its bytes a texel | JPEG | its bytes a texel |",
            "|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as work:
        pack = {}
        for name, (heights, *rest) in GROUNDS.items():
            bake = [os.path.join(options.bin, "farfield-bake"), os.path.join(data, heights), *rest[:-1], os.path.join(data, rest[-1]), *ERROR]
            pack[name] = os.path.join(work, name.split()[0])
            run([*bake, "--texture-quality", "100", "-o", pack[name]])
            row = []
            for codec in "picture", "jpeg":
                run([*bake, "--image-codec", codec, "-o", pack[name] + codec])
                row += ["%.0f" % instructions(options, pack[name] + codec)[0], "%.3f" % instructions(options, pack[name] + codec)[1]]
            cost.append("| %s | %s |" % (name, " | ".join(row)))
        for name, other in zip(GROUNDS, reversed(GROUNDS)):
            said = run([os.path.join(options.bin, "farfield-train"), "--pictures", "--measure", pack[name], pack[other]])
            text += ["## " + name, "", "```", said.replace(pack[name] + ", ", "").rstrip(), "```", ""]
    os.makedirs(options.out, exist_ok=True)
    with open(os.path.join(options.out, "pictures.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(text + cost) + "\n")
    print(os.path.join(options.out, "pictures.md"))


if __name__ == "__main__":
    main()
