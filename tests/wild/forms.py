"""Forms that shapes are made of, by Blender's modifiers and by formulas: each gives an object with a mesh. Run by
Blender's Python.
"""
import math

import bmesh
import bpy
import numpy as np


READ = {}


def linked(mesh):
    thing = bpy.data.objects.new("part", mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def from_arrays(points, faces):
    mesh = bpy.data.meshes.new("part")
    mesh.from_pydata([tuple(map(float, p)) for p in points], [], [tuple(map(int, f)) for f in faces])
    mesh.update()
    return linked(mesh)


def from_bmesh(build):
    form, mesh = bmesh.new(), bpy.data.meshes.new("part")
    build(form)
    form.to_mesh(mesh)
    form.free()
    return linked(mesh)


def modified(thing, kind, **settings):
    modifier = thing.modifiers.new(kind, kind)
    for key, value in settings.items():
        setattr(modifier, key, value)
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(thing.evaluated_get(graph))
    bpy.data.objects.remove(thing)
    return linked(mesh)


def combined(thing, other, how):
    result = modified(thing, "BOOLEAN", object=other, operation=how, solver="EXACT")
    bpy.data.objects.remove(other)
    return result


def moved(thing, by=(0, 0, 0), scale=(1, 1, 1), turn=(0, 0, 0)):
    from mathutils import Euler, Matrix

    thing.data.transform(Matrix.Translation(by) @ Euler(turn).to_matrix().to_4x4() @ Matrix.Diagonal((*scale, 1)))
    return thing


def ball(r=1.0, n=32):
    return from_bmesh(lambda b: bmesh.ops.create_uvsphere(b, u_segments=2 * n, v_segments=n, radius=r))


def icosphere(level=5):
    return from_bmesh(lambda b: bmesh.ops.create_icosphere(b, subdivisions=level, radius=1))


def cube(size=2.0):
    return from_bmesh(lambda b: bmesh.ops.create_cube(b, size=size))


def cylinder(r=1.0, h=2.0, n=64, r2=None):
    return from_bmesh(
        lambda b: bmesh.ops.create_cone(
            b, cap_ends=True, segments=n, radius1=r, radius2=r if r2 is None else r2, depth=h
        )
    )


def points_of(thing):
    points = np.empty(3 * len(thing.data.vertices))
    thing.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def with_points(thing, points):
    thing.data.vertices.foreach_set("co", np.ascontiguousarray(points).ravel())
    thing.data.update()
    return thing


def waves(points, rng, count, frequency):
    """Sum of plane waves of random directions and phases: a smooth random field, of about unit variance."""
    field = np.zeros(len(points))
    for _ in range(count):
        k = np.array([rng.gauss(0, 1) for _ in range(3)])
        field += np.sin(frequency * points @ k + rng.uniform(0, 2 * math.pi))
    return field * math.sqrt(2 / count)


def displaced(rng, amplitude, frequency, folded=False):
    thing = icosphere(5)
    points = points_of(thing)
    field = waves(points, rng, 12, frequency)
    field = np.abs(field) if folded else field
    return with_points(thing, points * (1 + amplitude * field)[:, None])


def grid(nx, ny, height, closed_below=None):
    """A height field over [-1, 1]^2; with `closed_below` a solid that reaches down to it."""
    x, y = np.meshgrid(np.linspace(-1, 1, nx), np.linspace(-1, 1, ny))
    top = np.column_stack((x.ravel(), y.ravel(), height(x.ravel(), y.ravel())))
    faces = [
        (j * nx + i, j * nx + i + 1, (j + 1) * nx + i + 1, (j + 1) * nx + i)
        for j in range(ny - 1)
        for i in range(nx - 1)
    ]
    if closed_below is None:
        return from_arrays(top, faces)
    rim = (
        [i for i in range(nx)]
        + [j * nx + nx - 1 for j in range(1, ny)]
        + [(ny - 1) * nx + i for i in range(nx - 2, -1, -1)]
        + [j * nx for j in range(ny - 2, 0, -1)]
    )
    first = len(top)
    low = np.array([[top[i][0], top[i][1], closed_below] for i in rim])
    n = len(rim)
    faces += [(rim[(k + 1) % n], rim[k], first + k, first + (k + 1) % n) for k in range(n)]
    faces.append(tuple(first + k for k in range(n - 1, -1, -1)))
    return from_arrays(np.vstack((top, low)), faces)


def lathe(profile, n=72, smooth=6):
    """(radius, height) from the bottom on the outside, and back inside if it is a vessel; turned about z."""
    p = np.array(profile, float)
    t = np.linspace(0, len(p) - 1, smooth * (len(p) - 1) + 1)
    p = np.column_stack([np.interp(t, range(len(p)), p[:, k]) for k in (0, 1)])
    for _ in range(smooth):  # rounded corners; the ends stay
        p[1:-1] = 0.5 * p[1:-1] + 0.25 * (p[:-2] + p[2:])
    angle = 2 * math.pi * np.arange(n) / n
    points = [(r * math.cos(a), r * math.sin(a), z) for r, z in p for a in angle]
    rows = len(p)
    faces = [
        (j * n + i, j * n + (i + 1) % n, (j + 1) * n + (i + 1) % n, (j + 1) * n + i)
        for j in range(rows - 1)
        for i in range(n)
    ]
    thing = from_arrays(points, faces)
    return from_bmesh_of(thing)


def from_bmesh_of(thing):
    """Doubles on the axis merged, faces without area dropped."""
    form = bmesh.new()
    form.from_mesh(thing.data)
    bmesh.ops.remove_doubles(form, verts=form.verts, dist=1e-6)
    bmesh.ops.dissolve_degenerate(form, edges=form.edges, dist=1e-7)
    form.to_mesh(thing.data)
    form.free()
    return thing


def tube(curve, radius, around=16, closed=True):
    """A pipe about a curve of points."""
    c = np.asarray(curve)
    tangent = np.roll(c, -1, 0) - np.roll(c, 1, 0) if closed else np.gradient(c, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    frame, n = np.cross(tangent[0], [0.3, 0.5, 0.8]), len(c)
    rings = []
    for i in range(n):
        frame = frame - tangent[i] * (frame @ tangent[i])
        frame /= np.linalg.norm(frame)
        other = np.cross(tangent[i], frame)
        a = 2 * math.pi * np.arange(around) / around
        rings.append(c[i] + radius * (np.cos(a)[:, None] * frame + np.sin(a)[:, None] * other))
    points = np.vstack(rings)
    last = n if closed else n - 1
    twist = 0
    if closed:  # the frame comes back turned: join each corner with the nearest one
        twist = int(np.argmin(np.linalg.norm(rings[0] - rings[-1][0], axis=1)))
    faces = []
    for i in range(last):
        shift = twist if i == n - 1 else 0
        for j in range(around):
            k, m = ((i + 1) % n) * around, (j + 1) % around
            faces.append((i * around + j, k + (j + shift) % around, k + (m + shift) % around, i * around + m))
    if not closed:
        faces += [tuple(range(around)), tuple((n - 1) * around + j for j in range(around - 1, -1, -1))]
    return from_arrays(points, faces)


def extruded(outline, height):
    n = len(outline)
    points = [(x, y, 0) for x, y in outline] + [(x, y, height) for x, y in outline]
    faces = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return from_arrays(points, faces + [tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n))])


def letter(sign):
    curve = bpy.data.curves.new("letter", "FONT")
    curve.body, curve.extrude, curve.resolution_u = sign, 0.12, 4
    thing = bpy.data.objects.new("letter", curve)
    bpy.context.scene.collection.objects.link(thing)
    mesh = bpy.data.meshes.new_from_object(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    bpy.data.objects.remove(thing)
    return moved(from_bmesh_of(linked(mesh)), turn=(math.pi / 2, 0, 0))


def power(x, p):
    return np.sign(x) * np.abs(x) ** p


def harmonics(rng):
    thing = icosphere(5)
    p = points_of(thing)
    a, b, m = rng.uniform(0.1, 0.25), rng.uniform(0.1, 0.25), rng.choice((2, 3, 4, 5))
    phi, z = np.arctan2(p[:, 1], p[:, 0]), p[:, 2]
    r = 1 + a * (3 * z * z - 1) / 2 + b * (1 - z * z) ** (m / 2) * np.cos(m * phi)
    return with_points(thing, p * r[:, None])


def superellipsoid(rng):
    e, n = rng.uniform(0.3, 1.6), rng.uniform(0.3, 1.6)
    thing = ball(1, 40)
    p = points_of(thing)
    v, u = np.arcsin(np.clip(p[:, 2], -1, 1)), np.arctan2(p[:, 1], p[:, 0])
    c = power(np.cos(v), n)
    return with_points(thing, np.column_stack((c * power(np.cos(u), e), c * power(np.sin(u), e), power(np.sin(v), n))))


def bunny(path):
    """The scan, with fewer triangles; read once."""
    if "bunny" not in READ:
        bpy.ops.import_mesh.ply(filepath=path)
        thing = bpy.context.selected_objects[0]
        bpy.context.view_layer.objects.active = None
        thing = modified(thing, "DECIMATE", ratio=min(1, 9000 / len(thing.data.polygons)))
        READ["bunny"] = points_of(thing), [tuple(p.vertices) for p in thing.data.polygons]
        bpy.data.objects.remove(thing)
    return from_arrays(*READ["bunny"])


def many(make, places):
    parts = [make(place) for place in places]
    with bpy.context.temp_override(active_object=parts[0], selected_editable_objects=parts, object=parts[0]):
        bpy.ops.object.join()
    return parts[0]


def monkey():
    mesh = bpy.data.meshes.new("part")
    form = bmesh.new()
    bmesh.ops.create_monkey(form)
    form.to_mesh(mesh)
    form.free()
    return linked(mesh)


def waved(rng, amplitude, frequency):
    state = rng.getstate()

    def height(x, y):
        rng.setstate(state)
        return amplitude * waves(np.column_stack((x, y, 0 * x)), rng, 8, frequency)

    return height


def toothed(teeth, inner):
    return [
        (
            (1 if k % 4 < 2 else inner) * math.cos(2 * math.pi * k / (4 * teeth)),
            (1 if k % 4 < 2 else inner) * math.sin(2 * math.pi * k / (4 * teeth)),
        )
        for k in range(4 * teeth)
    ]


def pointed(tips, inner):
    return [
        (
            (1 if k % 2 == 0 else inner) * math.cos(math.pi * k / tips),
            (1 if k % 2 == 0 else inner) * math.sin(math.pi * k / tips),
        )
        for k in range(2 * tips)
    ]


def twisted(turns):
    thing = grid_box(24)
    p = points_of(thing)
    a = turns * math.pi * p[:, 2] / 2
    return with_points(
        thing,
        np.column_stack(
            (p[:, 0] * np.cos(a) - p[:, 1] * np.sin(a), p[:, 0] * np.sin(a) + p[:, 1] * np.cos(a), p[:, 2])
        ),
    )


def grid_box(n):
    def build(form):
        bmesh.ops.create_cube(form, size=2)
        bmesh.ops.subdivide_edges(form, edges=form.edges, cuts=n, use_grid_fill=True)

    return moved(from_bmesh(build), scale=(0.5, 0.5, 1))


def metaballs(rng):
    parts = [
        moved(icosphere(4), scale=[rng.uniform(0.4, 0.6)] * 3, by=[rng.uniform(-0.5, 0.5) for _ in range(3)])
        for _ in range(4)
    ]
    whole = parts[0]
    for part in parts[1:]:
        whole = combined(whole, part, "UNION")
    return whole
