"""Shapes of several kinds: mesh_of(spec) gives a triangle mesh whose largest extent is `size_m`, which stands on z = 0
with its middle above the origin. Run by Blender's Python.
"""

import math
import random

import bmesh
import bpy
import numpy as np

from forms import *

SHARP = {
    "cube",
    "bitten_cube",
    "pierced_cylinder",
    "cross",
    "hollow_half",
    "gear",
    "star",
    "stairs",
    "cage",
    "letter_g",
    "letter_8",
    "letter_and",
    "letter_r",
    "cylinder",
    "bundle",
    "cone",
    "dome",
}  # shaded by facets


def built(kind, rng, bunny_path):
    u = rng.uniform
    turn = [i * 2 * math.pi / 240 for i in range(240)]
    outer = {
        "ball": lambda: ball(),
        "monkey": lambda: modified(monkey(), "SUBSURF", levels=1),
        "torus": lambda: tube([(math.cos(a), math.sin(a), 0) for a in turn[::3]], u(0.25, 0.45), 32),
        "cone": lambda: cylinder(1, u(1.2, 2.2), 64, u(0, 0.4)),
        "cylinder": lambda: cylinder(u(0.5, 1), 2, 96),
        "cube": lambda: moved(cube(), scale=(1, u(0.5, 1), u(0.5, 1))),
        "rounded_cube": lambda: modified(
            moved(cube(), scale=(1, u(0.6, 1), u(0.5, 1))), "BEVEL", width=0.25, segments=6
        ),
        "dome": lambda: combined(ball(1, 24), moved(cube(), by=(0, 0, -1)), "DIFFERENCE"),
        "stone": lambda: displaced(rng, u(0.05, 0.12), u(1, 2)),
        "potato": lambda: moved(displaced(rng, u(0.06, 0.1), 0.9), scale=(1, u(0.6, 0.8), u(0.5, 0.7))),
        "star_blob": lambda: displaced(rng, u(0.1, 0.2), u(1.5, 2.5), True),
        "dunes": lambda: grid(70, 70, waved(rng, u(0.08, 0.16), u(1.5, 3)), -0.4),
        "crumpled": lambda: displaced(rng, u(0.03, 0.06), u(3, 5), True),
        "bitten_cube": lambda: combined(cube(), moved(ball(u(0.7, 1.1), 20), by=(1, -1, 1)), "DIFFERENCE"),
        "bitten_ball": lambda: combined(ball(1, 28), moved(ball(0.7, 24), by=(u(0.6, 0.9), -0.6, 0.5)), "DIFFERENCE"),
        "pierced_cylinder": lambda: combined(
            cylinder(1, 1.6), moved(cylinder(0.5, 3, 48), turn=(u(0.9, 1.5), 0, u(0, 3))), "DIFFERENCE"
        ),
        "cross": lambda: combined(
            moved(cube(), scale=(1, 0.35, 0.35)), moved(cube(), scale=(0.35, 1, u(0.4, 1))), "UNION"
        ),
        "hollow_half": lambda: combined(
            moved(cube(), scale=(1, 1, 0.6)), moved(cube(), scale=(0.8, 0.8, 0.6), by=(0, 0, 0.3)), "DIFFERENCE"
        ),
        "vase": lambda: lathe(
            [
                (0, 0),
                (0.4, 0),
                (0.7, u(0.4, 0.8)),
                (0.3, 1.5),
                (u(0.4, 0.6), 2),
                (0.36, 1.9),
                (0.24, 1.5),
                (0.5, 0.7),
                (0, 0.15),
            ]
        ),
        "bowl": lambda: lathe(
            [(0, 0), (0.4, 0), (0.9, 0.4), (1, u(0.6, 0.9)), (0.93, 0.75), (0.8, 0.4), (0.3, 0.12), (0, 0.1)]
        ),
        "goblet": lambda: lathe(
            [
                (0, 0),
                (0.5, 0),
                (0.45, 0.08),
                (0.1, 0.2),
                (0.1, 0.8),
                (0.5, 1.1),
                (u(0.5, 0.7), 1.7),
                (0.5, 1.65),
                (0.4, 1.15),
                (0, 0.95),
            ]
        ),
        "bottle": lambda: lathe([(0, 0), (0.5, 0), (0.5, u(0.9, 1.3)), (0.2, 1.6), (0.2, 2), (0, 2)]),
        "pawn": lambda: lathe(
            [
                (0, 0),
                (0.5, 0),
                (0.5, 0.15),
                (0.2, 0.5),
                (0.18, 1),
                (0.35, 1.05),
                (0.15, 1.15),
                (0.33, 1.4),
                (0.2, 1.65),
                (0, 1.7),
            ]
        ),
        "bell": lambda: lathe(
            [(0, 0.9), (0.35, 0.8), (0.5, 0), (0.75, 0), (0.5, 0.5), (0.4, 0.95), (0.2, u(1.1, 1.3)), (0, 1.25)][::1]
        ),
        "letter_g": lambda: letter("g"),
        "letter_8": lambda: letter("8"),
        "letter_and": lambda: letter("&"),
        "letter_r": lambda: letter("R"),
        "bunny": lambda: bunny(bunny_path),
        "superellipsoid": lambda: superellipsoid(rng),
        "harmonics": lambda: harmonics(rng),
        "knot": lambda: tube(
            [
                ((2 + math.cos(3 * a)) * math.cos(2 * a), (2 + math.cos(3 * a)) * math.sin(2 * a), math.sin(3 * a))
                for a in turn
            ],
            u(0.3, 0.5),
        ),
        "spring": lambda: tube([(math.cos(4 * a), math.sin(4 * a), 0.35 * a) for a in turn], u(0.12, 0.2), 16, False),
        "gear": lambda: extruded(toothed(rng.choice((9, 12, 16)), 0.8), u(0.3, 0.6)),
        "star": lambda: extruded(pointed(rng.choice((5, 6, 7)), u(0.45, 0.6)), u(0.3, 0.7)),
        "stairs": lambda: moved(
            extruded([(0, 0), (4, 0), (4, 4), (3, 4), (3, 3), (2, 3), (2, 2), (1, 2), (1, 1), (0, 1)], u(2, 4)),
            turn=(math.pi / 2, 0, 0),
        ),
        "cage": lambda: modified(cube(), "WIREFRAME", thickness=u(0.25, 0.45)),
        "bundle": lambda: many(
            lambda p: moved(cylinder(0.24, p[2], 32), by=(p[0], p[1], p[2] / 2)),
            [(0.5 * math.cos(k * 1.2566), 0.5 * math.sin(k * 1.2566), u(0.8, 1.8)) for k in range(5)],
        ),
        "drops": lambda: modified(metaballs(rng), "REMESH", mode="VOXEL", voxel_size=0.06),
        "sheet": lambda: moved(grid(60, 40, waved(rng, u(0.06, 0.12), u(1, 1.6))), turn=(math.pi / 2, 0, 0)),
        "twisted_bar": lambda: twisted(u(0.5, 2)),
        "shell": lambda: modified(
            grid(48, 48, lambda x, y: 0.45 * (x * x + u(0.3, 0.6) * y * y)), "SOLIDIFY", thickness=0.08
        ),
    }
    return outer[kind]()


def dented(points, effect, size_m):
    """Pressed in about one of its points, as by a thumb."""
    at = points[int(effect["at"] * (len(points) - 1))]
    middle = points.mean(0)
    d = points - at
    inwards = (middle - at) / max(np.linalg.norm(middle - at), 1e-9)
    width = effect["width"] * size_m
    return points + effect["depth"] * size_m * np.exp(-(d * d).sum(1) / (2 * width * width))[:, None] * inwards


def mesh_of(spec, bunny_path, dent=None):
    """(Blender's mesh, points, triangles, normals of vertices or None where it is shaded by facets), in metres."""
    rng = random.Random(spec["mesh"]["number"])
    thing = built(spec["mesh"]["kind"], rng, bunny_path)
    form = bmesh.new()
    form.from_mesh(thing.data)
    bmesh.ops.remove_doubles(form, verts=form.verts, dist=1e-7)
    if spec["mesh"]["kind"] != "sheet":
        bmesh.ops.recalc_face_normals(form, faces=form.faces)
    bmesh.ops.triangulate(form, faces=form.faces)
    bmesh.ops.dissolve_degenerate(form, edges=form.edges, dist=1e-6)
    bmesh.ops.triangulate(form, faces=form.faces)
    form.to_mesh(thing.data)
    form.free()
    points = points_of(thing)
    low, high = points.min(0), points.max(0)
    points = (points - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]) * (spec["size_m"] / (high - low).max())
    points = np.float32(points)
    mesh = with_points(thing, points).data
    triangles = np.array([tuple(p.vertices) for p in mesh.polygons])
    flat = spec["flat"] or spec["mesh"]["kind"] in SHARP or creased(points, triangles, normals_of(mesh))
    if dent:
        points = np.float32(dented(points, dent, spec["size_m"]))
        mesh = with_points(thing, points).data
    bpy.data.objects.remove(thing)
    mesh.polygons.foreach_set("use_smooth", [not flat] * len(mesh.polygons))
    mesh.update()
    return mesh, points, triangles, None if flat else normals_of(mesh)


def normals_of(mesh):
    return np.array([tuple(v.normal) for v in mesh.vertices])


def creased(points, triangles, normals):
    """Edges that no two renderers smooth alike: normals of vertices more than 40 degrees from a triangle's?"""
    a, b, c = (points[triangles[:, k]].astype(float) for k in range(3))
    faces = np.cross(b - a, c - a)
    faces /= np.maximum(np.linalg.norm(faces, axis=1), 1e-30)[:, None]
    cosines = np.einsum("ick,ik->ic", normals[triangles], faces)
    return (cosines < math.cos(math.radians(40))).mean() > 0.003


def write_ply(path, points, triangles, normals):
    columns = ["x", "y", "z"] + (["nx", "ny", "nz"] if normals is not None else [])
    rows = np.float32(points if normals is None else np.hstack((points, normals)))
    faces = np.empty(len(triangles), [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, triangles
    head = "".join(
        [
            "ply\nformat binary_little_endian 1.0\n",
            f"element vertex {len(rows)}\n",
            *(f"property float {c}\n" for c in columns),
            f"element face {len(faces)}\n",
            "property list uchar int vertex_indices\nend_header\n",
        ]
    )
    with open(path, "wb") as file:
        file.write(head.encode() + rows.astype("<f4").tobytes() + faces.tobytes())
