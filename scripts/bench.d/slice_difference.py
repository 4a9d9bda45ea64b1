"""How far two archives of layers (zip files with PNG) are from each other, layer by layer, each layer of the second moved to
where it fits the first best by whole pixels. Usage: slice_difference.py PEER OURS"""
import struct
import sys
import zipfile
import zlib


def picture(data):
    at, packed, head = 8, b"", None
    while at < len(data):
        (size,) = struct.unpack(">I", data[at : at + 4])
        kind = data[at + 4 : at + 8]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", data[at + 8 : at + 8 + size])
        if kind == b"IDAT":
            packed += data[at + 8 : at + 8 + size]
        at += 12 + size
    width, height = head[0], head[1]
    raw, rows, above = zlib.decompress(packed), [], bytes(width)
    for y in range(height):
        kind, row = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1 : (y + 1) * (width + 1)])
        if kind == 1:
            for x in range(1, width):
                row[x] = row[x] + row[x - 1] & 255
        elif kind == 2:
            if any(row):
                row = bytearray(a + b & 255 for a, b in zip(row, above))
            else:
                row = bytearray(above)
        elif kind in (3, 4):
            for x in range(width):
                a, b, c = row[x - 1] if x else 0, above[x], above[x - 1] if x else 0
                p = a + b - c
                best = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                row[x] = row[x] + ((a + b) // 2 if kind == 3 else best) & 255
        above = bytes(row)
        rows.append(above)
    return width, height, rows


def layers(path):
    archive = zipfile.ZipFile(path)
    names = sorted(n for n in archive.namelist() if n.endswith(".png") and "thumbnail" not in n)
    return [(lambda n=n: picture(archive.read(n))) for n in names]


def box(rows):
    ys = [y for y, row in enumerate(rows) if any(row)]
    if not ys:
        return None
    lefts = [next(x for x, v in enumerate(rows[y]) if v) for y in ys]
    rights = [len(rows[y]) - next(x for x, v in enumerate(reversed(rows[y])) if v) for y in ys]
    return min(lefts), ys[0], max(rights), ys[-1] + 1


def difference(a, b):
    (x0, y0, x1, y1), (u0, v0, u1, v1) = box(a), box(b)
    best = None
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            total, edges = 0, 0
            for y in range(y0, y1):
                v = y - y0 + v0 + dy
                row = b[v][u0 + dx : u0 + dx + x1 - x0] if 0 <= v < len(b) and u0 + dx >= 0 else bytes(x1 - x0)
                if len(row) < x1 - x0 or row == a[y][x0:x1]:
                    continue
                for p, q in zip(a[y][x0:x1], row):
                    if p != q:
                        total, edges = total + (p - q) ** 2, edges + 1
            if best is None or total < best[0]:
                best = total, edges
    area = sum(sum(row) for row in a) / 255, sum(sum(row) for row in b) / 255
    rms = (best[0] / best[1]) ** 0.5 / 255 if best[1] else 0
    return area, best[1], rms


peer, ours = layers(sys.argv[1]), layers(sys.argv[2])
print("  layers: %d and %d" % (len(peer), len(ours)))
for share in (0.25, 0.5, 0.75):
    k = int(share * min(len(peer), len(ours)))
    (_, _, a), (_, _, b) = peer[k](), ours[k]()
    flipped = min((difference(a, rows) for rows in (b, b[::-1])), key=lambda d: d[2] * d[1])
    area, pixels, rms = flipped
    print("  layer %d: area %.1f and %.1f pixels; %d pixels differ, by %.3f of full light (rms)" % (k, *area, pixels, rms))
