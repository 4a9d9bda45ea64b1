# See cycles-subsurface. Run by Blender's own Python.
import math
import sys

import bpy
import numpy as np

folder, samples = sys.argv[sys.argv.index("--") + 1 :][:2]
RADII = (0.012, 0.005, 0.003)  # m, red, green, blue
random = np.random.default_rng(1)


def material(albedo, principled):
    m = bpy.data.materials.new("body")
    m.use_nodes = True
    tree = m.node_tree
    tree.nodes.clear()
    out = tree.nodes.new("ShaderNodeOutputMaterial")
    if principled:
        b = tree.nodes.new("ShaderNodeBsdfPrincipled")
        b.inputs["Subsurface"].default_value = 1
        b.inputs["Specular"].default_value = 0
        b.inputs["Base Color"].default_value = b.inputs["Subsurface Color"].default_value = (albedo,) * 3 + (1,)
        b.inputs["Subsurface Radius"].default_value = RADII
    else:
        b = tree.nodes.new("ShaderNodeSubsurfaceScattering")
        b.inputs["Color"].default_value = (albedo,) * 3 + (1,)
        b.inputs["Scale"].default_value = 1
        b.inputs["Radius"].default_value = RADII
    tree.links.new(b.outputs[0], out.inputs[0])
    return m


def black():
    m = bpy.data.materials.new("black")
    m.use_nodes = True
    m.node_tree.nodes.clear()
    out = m.node_tree.nodes.new("ShaderNodeOutputMaterial")
    b = m.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    b.inputs["Color"].default_value = (0, 0, 0, 1)
    m.node_tree.links.new(b.outputs[0], out.inputs[0])
    return m


def picture(albedo, principled, sun_deg, view_deg, wall):
    """Mean over the rows of a strip: a cube of 1 m under the sun, seen from above (or turned by view_deg)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = int(samples)
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, -0.5))
    bpy.context.object.scale = (2, 2, 1)
    bpy.context.object.data.materials.append(material(albedo, principled))
    if wall:  # its shadow ends at x = 0.2 m under a sun at 45 degrees
        bpy.ops.mesh.primitive_cube_add(size=1, location=(-0.001, 0, 0.1))
        bpy.context.object.scale = (0.002, 1.5, 0.2)
        bpy.context.object.data.materials.append(black())
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.angle, sun.data.energy = 0, 1
    sun.rotation_euler = (0, -math.radians(sun_deg), 0)
    eye = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
    eye.data.type = "ORTHO"
    eye.data.ortho_scale = 0.12 if wall else 0.02
    t = math.radians(view_deg)
    eye.location = (0.2 if wall else 0, -math.sin(t), math.cos(t))
    eye.rotation_euler = (t, 0, 0)
    for o in (sun, eye):
        scene.collection.objects.link(o)
    scene.camera = eye
    scene.render.resolution_x, scene.render.resolution_y = (240, 8) if wall else (8, 8)
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = folder + "/picture.exr"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(folder + "/picture.exr")
    values = np.array(image.pixels[:]).reshape(scene.render.resolution_y, scene.render.resolution_x, 4)
    bpy.data.images.remove(image)
    return values[..., :3].mean(0)


def walk_albedo(a):
    return 1 - math.exp(-5.09406 * a + 2.61188 * a * a - 4.31805 * a**3)


def dipole_alpha(albedo, eta=1.4):
    """Inverse of the dipole's diffuse reflectance with internal reflection: what Cycles shortens the radius by."""
    fdr = (-1.440 / eta + 0.710) / eta + 0.668 + 0.0636 * eta
    a = 4 / 3 * (1 + fdr) / (1 - fdr)
    lower, upper = 0.0, 1.0
    for _ in range(60):
        alpha = (lower + upper) / 2
        root = math.sqrt(3 * (1 - alpha))
        low = alpha / 2 * (1 + math.exp(-a * root)) * math.exp(-root) < albedo
        lower, upper = (alpha, upper) if low else (lower, alpha)
    return lower


def walks(alpha, count=300000):
    """Where walks of unit free path leave the half space z < 0, along x, and their weights."""
    mu, phi = -np.sqrt(random.random(count)), 2 * np.pi * random.random(count)
    x, z, weight = np.zeros(count), np.zeros(count), 1.0
    places, weights = [], []
    while len(x) and weight > 1e-4:
        dx, t = np.sqrt(1 - mu * mu) * np.cos(phi), -np.log(random.random(len(x)))
        out = z + mu * t > 0
        places.append(x[out] - dx[out] * z[out] / mu[out])
        weights.append(np.full(out.sum(), weight))
        x, z = (x + dx * t)[~out], (z + mu * t)[~out]
        mu, phi = 2 * random.random(len(x)) - 1, 2 * np.pi * random.random(len(x))
        weight *= alpha
    x, w = np.concatenate(places), np.concatenate(weights)
    order = np.argsort(x)
    return x[order], np.cumsum(w[order]) / w.sum()


table = open(folder + "/table.txt", "w")
across = (np.arange(240) - 119.5) * 0.12 / 240
for albedo in (0.3, 0.5, 0.75):
    edge = picture(albedo, False, 45, 0, True)
    alpha = walk_albedo(albedo)
    x, share = walks(alpha)
    for c, radius in enumerate(RADII):
        seen = edge[:, c] / edge[180:, c].mean()
        path = radius * math.sqrt(3 * (1 - dipole_alpha(albedo)))
        errors = [
            (np.sqrt(np.mean((np.interp(across, x * path * k, share) - seen) ** 2)), k)
            for k in np.exp(np.linspace(-0.6, 0.6, 61))
        ]
        error, k = min(errors)
        print(
            f"albedo {albedo:.2f} radius {radius * 1e3:4.1f} mm: free path of the walks {path * 1e3:.2f} mm, "
            f"best at {k:.2f} of it (rms {error:.4f}); diffuse mean free path over radius "
            f"{path / math.sqrt(3 * (1 - alpha)) / radius:.3f}",
            file=table,
        )
for sun, view in ((0, 0), (80, 0), (0, 80), (80, 80)):
    own = 0.5 / math.pi * math.cos(math.radians(sun))
    plain, principled = (picture(0.5, p, sun, view, False).mean() / own for p in (False, True))
    print(
        f"sun at {sun} degrees, seen at {view}: subsurface node {plain:.3f} of Lambert, principled {principled:.3f}",
        file=table,
    )
table.close()
