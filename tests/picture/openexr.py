"""A reader of OpenEXR files, written from the description of the file layout (openexr.com, "OpenEXR File Layout") with
the standard library alone, so that tests see a picture as another program does. Reads single-part files of scan lines
or of one level of tiles, not compressed or with RLE, ZIPS or ZIP.
"""
import struct
import zlib

LINES = {0: 1, 1: 1, 2: 1, 3: 16}  # per block, by compression: none, RLE, ZIPS, ZIP
COMPRESSIONS = ("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab")
SIZES = {0: 4, 1: 2, 2: 4}  # uint, half, float
CODES = {0: "I", 1: "e", 2: "f"}


class Header:
    def __init__(self, data):
        self.data = data
        magic, version = struct.unpack_from("<II", data, 0)
        assert magic == 20000630 and version & 0xFF == 2, "not an OpenEXR file"
        assert not version & 0x1800, "deep or of several parts"
        self.is_tiled = bool(version & 0x200)
        self.attributes = {}  # name -> (type, bytes)
        at = 8
        while data[at] != 0:
            name, at = self._text(at)
            kind, at = self._text(at)
            size, = struct.unpack_from("<i", data, at)
            self.attributes[name] = (kind, data[at + 4:at + 4 + size])
            at += 4 + size
        self.end = at + 1
        self.channels = self._channels()  # (name, type), in the order of the file
        self.window = struct.unpack("<4i", self.attributes["dataWindow"][1])
        self.display = struct.unpack("<4i", self.attributes["displayWindow"][1])
        self.compression = self.attributes["compression"][1][0]

    def _text(self, at):
        end = self.data.index(b"\0", at)
        return self.data[at:end].decode("utf-8"), end + 1

    def _channels(self):
        kind, raw = self.attributes["channels"]
        channels, at = [], 0
        while raw[at] != 0:
            end = raw.index(b"\0", at)
            kind, _, x_sampling, y_sampling = struct.unpack_from("<iiii", raw, end + 1)
            assert (x_sampling, y_sampling) == (1, 1)
            channels.append((raw[at:end].decode("utf-8"), kind))
            at = end + 17
        return channels

    def text(self, name):
        kind, raw = self.attributes[name]
        assert kind == "string", f"{name} is a {kind}"
        return raw.decode("utf-8")

    def texts(self):
        return {name: raw.decode("utf-8") for name, (kind, raw) in self.attributes.items() if kind == "string"}


def unpack_rle(packed):
    out, at = bytearray(), 0
    while at < len(packed):
        count = packed[at] - 256 if packed[at] > 127 else packed[at]
        if count < 0:
            out += packed[at + 1:at + 1 - count]
            at += 1 - count
        else:
            out += packed[at + 1:at + 2] * (count + 1)
            at += 2
    return bytes(out)


def unpack(block, size, compression):
    if compression == 0 or len(block) == size:
        return block
    raw = bytearray(unpack_rle(block) if compression == 1 else zlib.decompress(block))
    for i in range(1, len(raw)):
        raw[i] = (raw[i - 1] + raw[i] - 128) & 0xFF
    half = (len(raw) + 1) // 2
    joined = bytearray(len(raw))
    joined[0::2] = raw[:half]
    joined[1::2] = raw[half:]
    assert len(joined) == size, "a block has another size than its channels call for"
    return bytes(joined)


class Picture:
    """`values[channel]` has a number for each pixel of the data window, row by row."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        self.header = header = Header(data)
        assert header.compression in LINES, f"cannot decompress {COMPRESSIONS[header.compression]}"
        x0, y0, x1, y1 = header.window
        self.x0, self.y0, self.width, self.height = x0, y0, x1 - x0 + 1, y1 - y0 + 1
        self.values = {name: [None] * (self.width * self.height) for name, _ in header.channels}
        for x, y, width, height, block in self._blocks(data):
            self._place(x, y, width, height, block)

    def _blocks(self, data):
        """(x, y, width, height, compressed bytes) of every block, x and y relative to the data window."""
        header = self.header
        if header.is_tiled:
            size_x, size_y, mode = struct.unpack("<IIB", header.attributes["tiles"][1])
            assert mode & 0xF == 0, "several levels"
            count = -(-self.width // size_x) * -(-self.height // size_y)
        else:
            lines = LINES[header.compression]
            count = -(-self.height // lines)
        for offset in struct.unpack_from(f"<{count}Q", data, header.end):
            if header.is_tiled:
                column, row, _, _, size = struct.unpack_from("<5i", data, offset)
                x, y, start = column * size_x, row * size_y, offset + 20
                width, height = min(size_x, self.width - x), min(size_y, self.height - y)
            else:
                y, size = struct.unpack_from("<ii", data, offset)
                x, y, width, start = 0, y - self.y0, self.width, offset + 8
                height = min(lines, self.height - y)
            yield x, y, width, height, data[start:start + size]

    def _place(self, x, y, width, height, block):
        channels = self.header.channels
        size = height * width * sum(SIZES[kind] for _, kind in channels)
        raw, at = unpack(block, size, self.header.compression), 0
        for row in range(y, y + height):
            for name, kind in channels:
                first = row * self.width + x
                self.values[name][first:first + width] = struct.unpack_from(f"<{width}{CODES[kind]}", raw, at)
                at += width * SIZES[kind]

    def bits(self, name):
        """The bits of a channel of 32-bit floats, which are not rounded on the way."""
        assert dict(self.header.channels)[name] == 2, f"{name} is not of 32-bit floats"
        return [struct.unpack("<I", struct.pack("<f", value))[0] for value in self.values[name]]
