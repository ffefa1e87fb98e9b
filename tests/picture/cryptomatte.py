#!/usr/bin/env python3
"""Decodes the mattes of an OpenEXR file as the Cryptomatte specification 1.2 describes them (Psyop 2018).

  cryptomatte.py PICTURE.exr                  checks all that the specification demands and lists the names
  cryptomatte.py PICTURE.exr SAMPLES.txt      compares the mattes with those that follow from every sample: lines of
                                              "X Y FILTER-WEIGHT LAYER=ID LAYER=ID ..." with ids of 8 hex digits
  cryptomatte.py PICTURE.exr --levels         counts levels and the pixels whose mattes add up to less than alpha, of
                                              a picture whose filter has no negative weights
  cryptomatte.py PICTURE.exr --matte LAYER NAME   prints the mean of a matte over the picture
  cryptomatte.py PICTURE.exr --pgm LAYER NAME OUT.pgm   writes a matte as a grey picture

The mattes of a pixel must add up to its alpha if the picture has that and no id was left out. Exits with 1 and says
what is wrong.
"""
import collections
import json
import re
import struct
import sys

import openexr

TOLERANCE = 2e-5  # of sums of floats


def rotate(value, count):
    return ((value << count) | (value >> (32 - count))) & 0xFFFFFFFF


def murmur3_32(data, seed=0):
    def mixed(block):
        return rotate(block * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF
    value = seed
    whole = len(data) // 4 * 4
    for at in range(0, whole, 4):
        value = rotate(value ^ mixed(struct.unpack_from("<I", data, at)[0]), 13) * 5 + 0xE6546B64 & 0xFFFFFFFF
    if whole < len(data):
        value ^= mixed(int.from_bytes(data[whole:], "little"))
    value ^= len(data)
    value = (value ^ value >> 16) * 0x85EBCA6B & 0xFFFFFFFF
    value = (value ^ value >> 13) * 0xC2B2AE35 & 0xFFFFFFFF
    return value ^ value >> 16


def id_of(name):
    """The bits of the float that stands for a name: uint32_to_float32 avoids exponents of 0 and 255."""
    bits = murmur3_32(name.encode("utf-8"))
    exponent = min(max(bits >> 23 & 255, 1), 254)
    return bits & 0x807FFFFF | exponent << 23


def fail(message):
    sys.exit(f"cryptomatte.py: {message}")


def unique_pairs(pairs):
    names = [name for name, _ in pairs]
    if len(set(names)) != len(names):
        fail("a name is twice in a manifest")
    return dict(pairs)


class Layer:
    """The mattes of one kind: `pixels[i]` are pairs of id and coverage, by rank."""

    def __init__(self, picture, key):
        texts = picture.header.texts()
        self.name = texts[key + "name"]
        if re.fullmatch("cryptomatte/([0-9a-f]{7})/", key)[1] != f"{murmur3_32(self.name.encode()):08x}"[:7]:
            fail(f"{key} is not the key of {self.name}")
        if texts[key + "hash"] != "MurmurHash3_32" or texts[key + "conversion"] != "uint32_to_float32":
            fail(f"{self.name}: unknown hash or conversion")
        self.manifest = json.loads(texts[key + "manifest"], object_pairs_hook=unique_pairs)
        for name, value in self.manifest.items():
            if not re.fullmatch("[0-9a-f]{8}", value) or int(value, 16) != id_of(name):
                fail(f"{self.name}: {name!r} has the id {value}, not {id_of(name):08x}")
        self._read(picture)

    def _read(self, picture):
        names = {name for name, _ in picture.header.channels}
        columns = []
        self.levels = 0
        while f"{self.name}{self.levels:02}.R" in names:
            for id_channel, coverage in ("RG", "BA"):
                prefix = f"{self.name}{self.levels:02}."
                columns.append((picture.bits(prefix + id_channel), picture.values[prefix + coverage]))
            self.levels += 1
        if self.levels == 0:
            fail(f"{self.name}: there are no layers of ranks")
        ranked = re.compile(re.escape(self.name) + r"\d\d\.[RGBA]")
        if sum(ranked.fullmatch(name) is not None for name in names) != 4 * self.levels:
            fail(f"{self.name}: layers of ranks are missing or lack channels")
        self.pixels = []
        for i in range(picture.width * picture.height):
            ranks = [(ids[i], coverages[i]) for ids, coverages in columns]
            used = [rank for rank in ranks if rank[0] != 0]
            if ranks[:len(used)] != used or any(rank != (0, 0.0) for rank in ranks[len(used):]):
                fail(f"{self.name}: pixel {i} has a rank without an id before one with an id, or with coverage")
            if len({rank[0] for rank in used}) != len(used):
                fail(f"{self.name}: pixel {i} has an id twice")
            if any(a[1] < b[1] for a, b in zip(used, used[1:])):
                fail(f"{self.name}: pixel {i} is not sorted by coverage")
            self.pixels.append(used)

    def matte(self, name):
        wanted = id_of(name)
        return [sum(coverage for each, coverage in ranks if each == wanted) for ranks in self.pixels]

    def is_complete(self, i):
        """Whether the pixel has fewer ids than ranks, so that none was left out."""
        return len(self.pixels[i]) < 2 * self.levels


def layers_of(picture):
    keys = [match[1] for match in (re.fullmatch("(cryptomatte/.*/)name", name) for name in picture.header.texts())
            if match]
    return {layer.name: layer for layer in (Layer(picture, key) for key in keys)}


def check_sums(picture, layers):
    """The mattes of a pixel add up to its alpha. Returns how many pixels were compared."""
    alpha = picture.values.get("A")
    compared = 0
    for layer in layers.values():
        for i, ranks in enumerate(layer.pixels):
            total = sum(coverage for _, coverage in ranks)
            if alpha and layer.is_complete(i):
                compared += 1
                # Alpha may be a half.
                if abs(total - alpha[i]) > 1e-3 * max(1, abs(alpha[i])):
                    fail(f"{layer.name}: the mattes of pixel {i} add up to {total}, its alpha is {alpha[i]}")
    return compared


def count_levels(picture, layers):
    alpha = picture.values["A"]
    for layer in layers.values():
        short = 0
        for i, ranks in enumerate(layer.pixels):
            missing = alpha[i] - sum(coverage for _, coverage in ranks)
            if missing < -1e-3:
                fail(f"{layer.name}: the mattes of pixel {i} add up to more than its alpha")
            short += missing > 1e-3
        print(f"{layer.name}: {layer.levels} levels, {short} of {len(layer.pixels)} pixels short of alpha")


def read_samples(path):
    """Per pixel the sum of all filter weights, and per layer those of every id, as brute force has it."""
    totals = collections.defaultdict(float)
    weights = collections.defaultdict(lambda: collections.defaultdict(float))
    with open(path, encoding="ascii") as file:
        for line in file:
            x, y, weight, *ids = line.split()
            pixel = int(x), int(y)
            totals[pixel] += float(weight)
            for each in ids:
                layer, value = each.split("=")
                weights[pixel, layer][int(value, 16)] += float(weight)
    return totals, weights


def compare(picture, layers, path):
    totals, weights = read_samples(path)
    if len(totals) != picture.width * picture.height:
        fail(f"{path} has {len(totals)} pixels")
    compared = 0
    for layer in layers.values():
        for (x, y), total in totals.items():
            i = (y - picture.y0) * picture.width + x - picture.x0
            expected = {each: weight / total for each, weight in weights[(x, y), layer.name].items()}
            for rank, (each, coverage) in enumerate(layer.pixels[i]):
                if abs(coverage - expected.get(each, 0)) > TOLERANCE * max(1, abs(coverage)):
                    fail(f"{layer.name}: pixel ({x}, {y}) has {coverage} of {each:08x} at rank {rank}, "
                         f"not {expected.get(each, 0)}")
            left_out = [expected[each] for each in expected if each not in dict(layer.pixels[i])]
            if left_out and layer.is_complete(i):
                fail(f"{layer.name}: pixel ({x}, {y}) lacks an id")
            if left_out and max(left_out) > layer.pixels[i][-1][1] + TOLERANCE:
                fail(f"{layer.name}: pixel ({x}, {y}) lacks an id that covers more than its last rank")
            compared += len(layer.pixels[i])
    print(f"{compared} coverages agree with every sample")


def write_pgm(picture, matte, path):
    grey = bytes(round(255 * min(max(value, 0), 1)) for value in matte)
    with open(path, "wb") as file:
        file.write(b"P5 %d %d 255\n" % (picture.width, picture.height) + grey)


def main(arguments):
    picture = openexr.Picture(arguments[0])
    layers = layers_of(picture)
    if not layers:
        fail("there are no mattes")
    compared = check_sums(picture, layers)
    if compared:
        print(f"{compared} pixels of mattes add up to alpha")
    rest = arguments[1:]
    if not rest:
        for layer in layers.values():
            print(f"{layer.name}: {json.dumps(list(layer.manifest), ensure_ascii=False)}")
    elif rest[0] == "--levels":
        count_levels(picture, layers)
    elif rest[0] == "--matte":
        matte = layers[rest[1]].matte(rest[2])
        print(sum(matte) / len(matte))
    elif rest[0] == "--pgm":
        write_pgm(picture, layers[rest[1]].matte(rest[2]), rest[3])
    else:
        compare(picture, layers, rest[0])


if __name__ == "__main__":
    main(sys.argv[1:])
