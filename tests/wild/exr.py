"""OpenEXR files, as much as is needed: Blender's uncompressed 32 bit layers are read, 16 bit pictures written with ZIP.
File layout: Kainz, Bogart & Hess, "Technical introduction to OpenEXR" and "OpenEXR file layout"; numpy alone.
"""
import struct
import zlib

import numpy as np

MAGIC = struct.pack("<ii", 20000630, 2)


def header_of(data):
    """{name: (type, bytes)} and where the header ends."""
    at, found = 8, {}
    while data[at] != 0:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), end + 1
        end = data.index(b"\0", at)
        kind, at = data[at:end].decode(), end + 1
        size = struct.unpack_from("<i", data, at)[0]
        found[name] = (kind, data[at + 4 : at + 4 + size])
        at += 4 + size
    return found, at + 1


def read_layers(path):
    """{channel: height x width} of an uncompressed file of 32 bit channels."""
    with open(path, "rb") as file:
        data = file.read()
    header, at = header_of(data)
    if header["compression"][1] != b"\0":
        raise ValueError(path + ": is compressed")
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names, chlist, p = [], header["channels"][1], 0
    while chlist[p] != 0:
        end = chlist.index(b"\0", p)
        names.append(chlist[p:end].decode())
        if struct.unpack_from("<i", chlist, end + 1)[0] != 2:
            raise ValueError(path + ": channel " + names[-1] + " is not of 32 bit")
        p = end + 17
    lines = np.empty((height, len(names), width), np.float32)
    for offset in struct.unpack_from(f"<{height}Q", data, at):
        y = struct.unpack_from("<i", data, offset)[0] - y0
        lines[y] = np.frombuffer(data, "<f4", len(names) * width, offset + 8).reshape(len(names), width)
    return {name: lines[:, i, :] for i, name in enumerate(names)}


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def write_picture(path, picture):
    """height x width x 3, linear red, green, blue: 16 bit, ZIP. The values as they will be read."""
    halves = np.clip(picture, -65504, 65504).astype("<f2")
    height, width, _ = halves.shape
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(n + b"\0" + struct.pack("<iiii", 1, 0, 1, 1) for n in (b"B", b"G", b"R")) + b"\0"
    head = (
        MAGIC
        + b"".join(
            (
                attribute("channels", "chlist", channels),
                attribute("compression", "compression", b"\3"),
                attribute("dataWindow", "box2i", window),
                attribute("displayWindow", "box2i", window),
                attribute("lineOrder", "lineOrder", b"\0"),
                attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
                attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
                attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
            )
        )
        + b"\0"
    )
    planes = np.ascontiguousarray(np.moveaxis(halves[:, :, ::-1], 2, 1))  # rows of blue, green, red
    blocks = []
    for top in range(0, height, 16):
        raw = planes[top : top + 16].tobytes()
        bytes_ = np.frombuffer(raw, np.uint8)
        split = np.concatenate((bytes_[0::2], bytes_[1::2])).astype(np.int16)
        split[1:] = (split[1:] - split[:-1] + 128) & 255
        packed = zlib.compress(split.astype(np.uint8).tobytes(), 6)
        packed = packed if len(packed) < len(raw) else raw
        blocks.append(struct.pack("<ii", top, len(packed)) + packed)
    at, table = len(head) + 8 * len(blocks), b""
    for block in blocks:
        table, at = table + struct.pack("<Q", at), at + len(block)
    with open(path, "wb") as file:
        file.write(head + table + b"".join(blocks))
    return halves.astype(np.float64)
