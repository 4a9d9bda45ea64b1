"""The scene of a plan in Blender, as the manifest states it or with what it leaves out, and its renderings: radiance of
each camera by each lamp alone, twice, with independent samples. Run by Blender's Python.

Cycles without its conveniences: box filter of one pixel, no clamping, no denoiser. Lamps: a point of power P has the
intensity P / (4 pi); a sun's strength is the irradiance on a facing plane. Each lamp is rendered alone: lamp states and
exposures are sums of the same renderings.
"""
import math
import os

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

import camera_chain
import draw
import exr
import materials
import meshes

GROUND_M = 1.2
WALLS = (((0, 0.30, 0.3), (math.pi / 2, 0, 0)), ((-0.34, 0, 0.3), (0, math.pi / 2, 0)))  # places and turns of walls
WALL_M = 0.6


def find(plan, name, key=None, value=None):
    for e in plan["effects"]:
        if e["name"] == name and (key is None or e[key] == value):
            return e
    return None


def without_scene_effects(plan):
    import effects

    return {**plan, "effects": [e for e in plan["effects"] if e["name"] in effects.CHAIN_NAMES], "lamp_errors": None}


def settings():
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_percentage = 100
    render.use_persistent_data = True
    render.threads_mode, render.threads = "FIXED", 1
    render.use_compositing = render.use_sequencer = False
    render.dither_intensity = 0
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.light_sampling_threshold = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 24
    cycles.transmission_bounces = cycles.volume_bounces = cycles.transparent_max_bounces = 24
    cycles.use_auto_tile = False
    layer = scene.view_layers[0]
    layer.use_pass_material_index = True


def along_minus_z(direction):
    return Vector(direction).to_track_quat("-Z", "Y")


def placed(mesh, location, rotation, scale=1.0):
    thing = bpy.data.objects.new("thing", mesh)
    bpy.context.scene.collection.objects.link(thing)
    thing.rotation_mode = "QUATERNION"
    thing.location, thing.rotation_quaternion, thing.scale = location, rotation, (scale,) * 3
    return thing


def plane(size_m, location, turn, made):
    h = size_m / 2
    mesh = bpy.data.meshes.new("plane")
    mesh.from_pydata([(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(made)
    from mathutils import Euler

    return placed(mesh, location, Euler(turn).to_quaternion())


def turned(vector, by):
    """A vector turned by a rotation vector."""
    angle = math.sqrt(sum(x * x for x in by))
    return Quaternion(by, angle) @ Vector(vector) if angle > 0 else Vector(vector)


def build_bodies(plan, shapes):
    """Objects, ground and walls; fills `shapes` with what the manifest needs of each object. Indices of materials:
    1 the ground, 2 walls, 3... the objects."""
    for i, spec in enumerate(plan["objects"]):
        mesh, points, triangles, normals = meshes.mesh_of(spec, plan["bunny"], find(plan, "dent", "body", i))
        low, high = points.min(0), points.max(0)
        own = next((e for e in plan["effects"] if e.get("body") == i and e["name"] in plan["material_names"]), None)
        at = points[int((own or {}).get("at", 0) * (len(points) - 1))]
        mesh.materials.clear()
        mesh.materials.append(
            materials.material(spec["albedo"], own, (low.tolist(), high.tolist(), at.tolist()), 3 + i)
        )
        place, turn, size = Vector((spec["x"], spec["y"], 0)), Quaternion((0, 0, 1), spec["turn"]), 1.0
        shapes.append(
            {
                "points": points,
                "triangles": triangles,
                "normals": normals,
                "place": list(place),
                "turn": list(turn),
                "at": at.tolist(),
            }
        )
        shift = find(plan, "pose", "body", i)
        if shift:
            angle = math.sqrt(sum(x * x for x in shift["turn_rad"]))
            place = place + Vector(shift["shift_m"])
            turn = Quaternion(shift["turn_rad"], angle) @ turn
        growth = find(plan, "scale", "body", i)
        placed(mesh, place, turn, size * (1 + growth["growth"]) if growth else size)
    plane(GROUND_M, (0, 0, 0), (0, 0, 0), materials.material(plan["ground_albedo"], None, None, 1))
    for place, turn in WALLS[: plan["walls"]]:
        plane(WALL_M, place, turn, materials.material(plan["wall_albedo"], None, None, 2))
    extra = find(plan, "missing_object")
    if extra:
        spec = {"mesh": {"kind": extra["mesh"], "number": 1}, "size_m": extra["size_m"], "flat": False}
        mesh = meshes.mesh_of(spec, plan["bunny"])[0]
        mesh.materials.clear()
        mesh.materials.append(materials.material([extra["albedo"]] * 3, None, None, 0))
        placed(mesh, (extra["x"], extra["y"], 0), Quaternion())
    air = find(plan, "fog")
    if air:
        mesh = meshes.cube(4.0).data
        mesh.materials.append(materials.fog(air))


def light(kind, power, name, location=(0, 0, 0), towards=(0, 0, 1), radius=0.0):
    data = bpy.data.lights.new(name, kind)
    largest = max(power)
    data.energy, data.color = largest, [p / largest for p in power]
    data.cycles.max_bounces = 1024
    thing = bpy.data.objects.new(name, data)
    thing.rotation_mode, thing.location = "QUATERNION", location
    thing.rotation_quaternion = along_minus_z([-c for c in towards])
    thing.visible_camera = False
    if kind == "SUN":
        data.angle = radius
    else:
        data.shadow_soft_size = radius
    bpy.context.scene.collection.objects.link(thing)
    thing.lightgroup = name  # what it is called from here on
    return thing


def with_lobe(thing, exponent, axis):
    """The lamp's emission times the cosine to a power, about an axis of the world."""
    thing.data.use_nodes = True
    tree = thing.data.node_tree
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    along = tree.nodes.new("ShaderNodeVectorMath")
    along.operation = "DOT_PRODUCT"
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Incoming"], along.inputs[0])
    along.inputs[1].default_value = axis
    last = along.outputs["Value"]
    for operation, number in (("MAXIMUM", 1e-4), ("POWER", exponent)):
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        tree.links.new(last, node.inputs[0])
        node.inputs[1].default_value = number
        last = node.outputs[0]
    tree.links.new(last, emission.inputs["Strength"])


def build_lamps(plan):
    size, aside = find(plan, "finite_size"), find(plan, "lamp_position")
    cone, shape, errors = find(plan, "spot_cone"), find(plan, "lobe"), plan.get("lamp_errors")
    for i, lamp in enumerate(plan["lamps"]):
        name, colour = f"lamp{i}", [lamp["power"] * c for c in lamp["colour"]]
        if lamp["kind"] == "sun":
            towards = Vector(lamp["towards"])
            off = find(plan, "lamp_direction", "lamp", i)
            towards = turned(towards, off["turn"]) if off else towards
            light("SUN", [2.5 * c for c in colour], name, towards=towards, radius=size["sun_rad"] if size else 0.0)
            continue
        place = Vector(lamp["position_m"])
        for off in (aside, find(plan, "one_lamp_misplaced", "lamp", i)):
            place = place + Vector(off["shift_m"]) if off else place
        if errors:
            place = place + Vector(errors[i])
        radius = size["radius_m"] if size and lamp["kind"] == "point" else lamp["radius_m"]
        power = [4 * math.pi * c for c in colour]
        if cone and lamp["kind"] == "point":
            axis = Vector(cone["aside"]) + Vector((0, 0, 0.03)) - place
            thing = light("SPOT", power, name, place, -axis, radius)
            thing.data.spot_size = min(3.1, 2 * cone["outer"] * 0.25 / axis.length)
            thing.data.spot_blend = cone["blend"]
            continue
        thing = light("POINT", power, name, place, radius=radius)
        if shape and lamp["kind"] == "point":
            with_lobe(thing, shape["exponent"], (Vector((0, 0, 0.03)) - place).normalized())
    build_extra_light(plan)


def build_card(lamp, place, normal, paper, cells=4):
    """What a card that faces the lamp sends back, as small lamps: found by chance it would be noise. Each cell has the
    radiance albedo / pi I cos / d^2. Light from the scene to the card and back is left out."""
    turn = along_minus_z(normal)
    across, up = turn @ Vector((1, 0, 0)), turn @ Vector((0, 1, 0))
    side = paper["size_m"] / cells
    for k in range(cells * cells):
        u, v = (k % cells + 0.5) * side - paper["size_m"] / 2, (k // cells + 0.5) * side - paper["size_m"] / 2
        centre = place - paper["distance_m"] * normal + u * across + v * up
        d = (place - centre).length
        radiance = paper["albedo"] / math.pi * (paper["distance_m"] / d) / d**2
        data = bpy.data.lights.new("card", "AREA")
        data.shape, data.size, data.spread = "SQUARE", side, math.pi
        data.color = [c / max(lamp["colour"]) for c in lamp["colour"]]
        data.energy = 4 * side**2 * radiance * lamp["power"] * max(lamp["colour"])
        thing = bpy.data.objects.new("card", data)
        thing.rotation_mode, thing.location, thing.rotation_quaternion = "QUATERNION", centre, turn
        thing.visible_camera = False
        thing.lightgroup = "card"
        bpy.context.scene.collection.objects.link(thing)


def build_extra_light(plan):
    other = find(plan, "second_lamp")
    if other:
        c = math.cos(other["elevation"])
        towards = Vector((c * math.cos(other["azimuth"]), c * math.sin(other["azimuth"]), math.sin(other["elevation"])))
        if other["far"]:
            light("SUN", [2.5 * other["share"]] * 3, "extra", towards=towards)
        else:
            light("POINT", [4 * math.pi * other["share"]] * 3, "extra", 0.6 * towards, radius=0.01)
    paper = find(plan, "card")
    if paper:
        place = Vector(plan["lamps"][paper["lamp"]]["position_m"])
        out = Matrix.Rotation(paper["turn"], 3, "Z") @ Vector((1, 0, 0.2))
        normal = ((Vector((0, 0, 0.05)) - place).normalized() - 0.8 * out).normalized()
        build_card(plan["lamps"][paper["lamp"]], place, normal, paper)
    sky = find(plan, "ambient")
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes = world.node_tree.nodes
    background = next(n for n in nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0, 0, 0, 1)
    if sky:
        background.inputs["Color"].default_value = (*[2.5 / math.pi * sky["share"] * c for c in sky["colour"]], 1)
        if sky["from_above"]:  # half of it from above, rising with the sine of the elevation
            make = world.node_tree
            up = make.nodes.new("ShaderNodeSeparateXYZ")
            make.links.new(make.nodes.new("ShaderNodeTexCoord").outputs["Generated"], up.inputs[0])
            level = make.nodes.new("ShaderNodeMapRange")
            level.inputs["From Min"].default_value = -1
            make.links.new(up.outputs["Z"], level.inputs["Value"])
            make.links.new(level.outputs[0], background.inputs["Strength"])


def camera_pose(camera, nudge=None):
    """world_from_camera, x right, y down, z forward: rotation 3 x 3, and the place."""
    right, down, forward = draw.camera_axes(camera)
    place = Vector(camera["position_m"])
    rotation = Matrix((right, down, forward)).transposed()
    if nudge:
        angle = math.sqrt(sum(x * x for x in nudge["turn"]))
        rotation = Quaternion(nudge["turn"], angle).to_matrix() @ rotation
        place = place + Vector(nudge["shift_m"])
    return np.array(rotation), np.array(place)


def aim(camera, nudge, lens, blur):
    rotation, place = camera_pose(camera, nudge)
    data = bpy.data.cameras.new("eye")
    width, height, f = camera["width"], camera["height"], camera["focal_px"]
    if lens:
        n = camera_chain.FINE
        width, height, f = n * (width + 2 * camera_chain.MARGIN_PX), n * (height + 2 * camera_chain.MARGIN_PX), n * f
    data.sensor_fit, data.sensor_width, data.lens = "HORIZONTAL", 36, 36 * f / width
    data.clip_start, data.clip_end = 1e-3, 100
    if blur:
        away = math.dist(camera["position_m"], camera["target_m"])
        data.dof.use_dof = True
        data.dof.focus_distance = away * blur["focus"]
        data.dof.aperture_fstop = data.lens * 1e-3 / (2 * blur["aperture_radius_m"])
    eye = bpy.data.objects.new("eye", data)
    bpy.context.scene.collection.objects.link(eye)
    turn = Matrix((rotation @ np.diag((1, -1, -1))).tolist()).to_4x4()
    eye.matrix_world = Matrix.Translation(place) @ turn
    bpy.context.scene.camera = eye
    return width, height


def shine_alone(name, dark, sky):
    """Of all that shines only this: no sample is lost on choosing among lamps."""
    scene = bpy.context.scene
    scene.world = sky if name == "sky" else dark
    for thing in scene.objects:
        if thing.type == "LIGHT":
            thing.hide_render = thing.lightgroup != name


def one_rendering(name, samples, seed, scratch):
    """(radiance, indices of materials)."""
    render, cycles = bpy.context.scene.render, bpy.context.scene.cycles
    cycles.samples, cycles.seed = samples, seed
    render.filepath = os.path.join(scratch, "rendering.exr")
    bpy.ops.render.render(write_still=True)
    layers = exr.read_layers(render.filepath)
    radiance = np.stack([layers[f"ViewLayer.Combined.{channel}"] for channel in "RGB"], 2).astype(np.float64)
    return radiance, np.rint(layers["ViewLayer.IndexMA.X"]).astype(int)


def shines_in(plan, name, picture):
    """Does what bears this name send light into the picture?"""
    if name == "card":
        return find(plan, "card")["lamp"] in picture["lamps"]
    return not name.startswith("lamp") or int(name[4:]) in picture["lamps"]


def renderings(plan, samples, scratch, lens, apart):
    """Shapes, and for each camera {lamp: {number of the picture: [half, half]}} of radiance with {"surface": index of
    material}. `samples` of a pixel and half are shared among the lamps; equal seeds for equal places, so that versions
    of a scene differ little. `apart`: every picture has samples of its own, as no two photographs share their noise.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_mesh_ply")
    settings()
    shapes, views = [], []
    build_bodies(plan, shapes)
    build_lamps(plan)
    sky, dark = bpy.context.scene.world, bpy.data.worlds.new("dark")
    dark.color = (0, 0, 0)
    names = {t.lightgroup: None for t in bpy.context.scene.objects if t.type == "LIGHT"}
    names = list(names) + (["sky"] if find(plan, "ambient") else [])
    each = max(2 if lens else 8, round(samples / len(names) / (camera_chain.FINE**2 if lens else 1)))
    for c, camera in enumerate(plan["cameras"]):
        nudge = find(plan, "camera_nudged", "camera", c)
        width, height = aim(camera, nudge, lens, find(plan, "defocus"))
        render = bpy.context.scene.render
        render.resolution_x, render.resolution_y = width, height
        found = {}
        for number, name in enumerate(names):
            pictures = [p["number"] for p in plan["pictures"] if p["camera"] == c and shines_in(plan, name, p)]
            if not pictures:
                continue
            shine_alone(name, dark, sky)
            takes = []
            for take in range(len(pictures) if apart else 1):
                seed = 1 + 1000 * take + 100 * c + 10 * number
                both = [one_rendering(name, each, seed + half, scratch) for half in range(2)]
                takes.append([radiance for radiance, _ in both])
                found["surface"] = both[0][1]
            found[name] = {p: takes[k if apart else 0] for k, p in enumerate(pictures)}
        views.append(found)
    return shapes, views
