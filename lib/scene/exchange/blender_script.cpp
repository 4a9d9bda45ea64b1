// Python for Blender 3.x (formats/blender.cpp says which conventions its numbers follow).
#include "scene/exchange/blender_script.h"

namespace gonio::scene {

const std::string_view blender_script_head = R"py(# A scene for Blender's Cycles.
#   blender -b --factory-startup -noaudio -P scene.py -- --image ID --spp N --threads N --out x.exr
# Without --out it only builds the scene (to look at it, or to save it from Blender).
import array
import json
import math
import os
import sys
import time

import bpy
from mathutils import Quaternion, Vector

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = json.loads(r'''
)py";

const std::string_view blender_script_building = R"py('''.replace("\\u0027", "'"))


def arguments():
    import argparse
    parser = argparse.ArgumentParser(prog="scene.py")
    parser.add_argument("--image", default=SCENE["images"][0]["id"] if SCENE["images"] else None)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])


def read_ply(path):
    """Positions, normals, texture coordinates and triangles of the files that stand beside this script."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii").split("\n")
    count = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
    columns = [line.split()[2] for line in header if line.startswith("property float")]
    rows, stride = count["vertex"], len(columns)
    floats = array.array("f", data[end:end + 4 * stride * rows])

    def taken(names):
        if not all(name in columns for name in names):
            return None
        result = array.array("f", bytes(4 * len(names) * rows))
        for i, name in enumerate(names):
            result[i::len(names)] = floats[columns.index(name)::stride]
        return result

    faces = data[end + 4 * stride * rows:]
    indices = bytearray(12 * count["face"])
    for i in range(12):
        indices[i::12] = faces[1 + i::13]
    return taken("xyz"), taken(("nx", "ny", "nz")), taken("st"), array.array("i", bytes(indices))


def make_mesh(name, entry):
    co, normals, st, corners = read_ply(os.path.join(HERE, entry["file"]))
    mesh = bpy.data.meshes.new(name)
    faces = len(corners) // 3
    mesh.vertices.add(len(co) // 3)
    mesh.vertices.foreach_set("co", co)
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(faces)
    mesh.polygons.foreach_set("loop_start", array.array("i", range(0, 3 * faces, 3)))
    mesh.polygons.foreach_set("loop_total", array.array("i", [3]) * faces)
    mesh.polygons.foreach_set("use_smooth", array.array("b", [1 if normals else 0]) * faces)
    if st:
        layer = mesh.uv_layers.new(name="uv")
        uv = array.array("f", bytes(8 * len(corners)))
        uv[0::2] = array.array("f", (st[2 * i] for i in corners))
        uv[1::2] = array.array("f", (st[2 * i + 1] for i in corners))
        layer.data.foreach_set("uv", uv)
    mesh.update(calc_edges=True)
    if normals:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = math.pi
        mesh.normals_split_custom_set_from_vertices(list(zip(normals[0::3], normals[1::3], normals[2::3])))
    return mesh


def load_picture(file):
    image = bpy.data.images.load(os.path.join(HERE, file), check_existing=True)
    image.colorspace_settings.name = "Non-Color"  # linear as it is
    image.use_half_precision = False
    return image


class Nodes:
    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def add(self, kind, settings=None, **inputs):
        node = self.tree.nodes.new(kind)
        for key, value in (settings or {}).items():
            setattr(node, key, value)
        for key, value in inputs.items():
            socket = node.inputs[key.replace("_", " ")]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            elif socket.type == "RGBA":
                socket.default_value = (*value, 1)
            else:
                socket.default_value = value
        return node.outputs[0]

    def join(self, kind, a, b, fac=None):
        node = self.tree.nodes.new(kind)
        first = 0
        if kind == "ShaderNodeMixShader":
            first = 1
            if isinstance(fac, bpy.types.NodeSocket):
                self.tree.links.new(fac, node.inputs[0])
            else:
                node.inputs[0].default_value = fac
        self.tree.links.new(a, node.inputs[first])
        self.tree.links.new(b, node.inputs[first + 1])
        return node.outputs[0]

    def sum(self, sockets):
        total = None
        for socket in sockets:
            total = socket if total is None else self.join("ShaderNodeAddShader", total, socket)
        return total


def value_or_texture(nodes, entry, key, factor=None):
    texture = entry.get("textures", {}).get(key)
    if not texture:
        return entry[key]
    settings = {"image": load_picture(texture), "interpolation": "Linear", "extension": "REPEAT"}
    value = nodes.add("ShaderNodeTexImage", settings)
    if factor is not None and factor != 1:
        value = nodes.add("ShaderNodeVectorMath", {"operation": "SCALE"}, Vector=value, Scale=factor)
    return value


def roughness(nodes, entry):
    """Cycles squares its roughness."""
    value = value_or_texture(nodes, entry, "alpha")
    if isinstance(value, bpy.types.NodeSocket):
        return nodes.add("ShaderNodeMath", {"operation": "SQRT"}, Value=value)
    return math.sqrt(value)


def distribution(entry):
    if entry["alpha"] == 0 and "alpha" not in entry.get("textures", {}):
        return "SHARP"
    return "BECKMANN" if entry["beckmann"] else "GGX"


def matte(nodes, entry):
    return nodes.add("ShaderNodeBsdfDiffuse", Color=value_or_texture(nodes, entry, "color", entry["scale"]),
                     Roughness=entry["oren_nayar"])


def coated(nodes, entry):
    fresnel = nodes.add("ShaderNodeFresnel", IOR=entry["ior"])
    gloss = nodes.add("ShaderNodeBsdfGlossy", {"distribution": distribution(entry)}, Color=(1, 1, 1),
                      Roughness=roughness(nodes, entry))
    below = subsurface(nodes, entry) if entry["kind"] == "translucent" else matte(nodes, entry)
    return nodes.join("ShaderNodeMixShader", below, gloss, fresnel)


def subsurface(nodes, entry):
    return nodes.add("ShaderNodeSubsurfaceScattering", {"falloff": "RANDOM_WALK"}, Color=entry["color"], Scale=1.0,
                     Radius=entry["radius"], IOR=entry["ior"], Anisotropy=entry["g"])


def metal(nodes, entry):
    if distribution(entry) == "SHARP" or entry["beckmann"]:
        return nodes.add("ShaderNodeBsdfGlossy", {"distribution": distribution(entry)},
                         Color=value_or_texture(nodes, entry, "color"), Roughness=roughness(nodes, entry))
    return nodes.add("ShaderNodeBsdfPrincipled", {"distribution": "MULTI_GGX"}, Metallic=1.0, Specular=0.5,
                     Base_Color=value_or_texture(nodes, entry, "color"), Roughness=roughness(nodes, entry),
                     Anisotropic=entry["anisotropic"], Anisotropic_Rotation=entry["anisotropic_rotation"])


def with_coat(nodes, entry, below):
    if entry["coat_ior"] == 0:
        return below
    fresnel = nodes.add("ShaderNodeFresnel", IOR=entry["coat_ior"])
    kind = {"distribution": "GGX" if entry["coat_alpha"] > 0 else "SHARP"}
    gloss = nodes.add("ShaderNodeBsdfGlossy", kind, Color=(1, 1, 1), Roughness=math.sqrt(entry["coat_alpha"]))
    return nodes.join("ShaderNodeMixShader", below, gloss, fresnel)


def glass(nodes, entry):
    if abs(entry["ior"] - 1) < 1e-6:
        return nodes.add("ShaderNodeBsdfTransparent", Color=(1, 1, 1))
    return nodes.add("ShaderNodeBsdfGlass", {"distribution": distribution(entry)}, Color=(1, 1, 1),
                     IOR=entry["ior"], Roughness=roughness(nodes, entry))


def inside(nodes, entry):
    """Absorption is density (1 - colour), scattering density times colour."""
    parts = []
    absorbs, scatters = max(entry["sigma_a"]), max(entry["sigma_s"])
    if absorbs > 0:
        parts.append(nodes.add("ShaderNodeVolumeAbsorption", Density=absorbs,
                               Color=[1 - s / absorbs for s in entry["sigma_a"]]))
    if scatters > 0:
        parts.append(nodes.add("ShaderNodeVolumeScatter", Density=scatters, Anisotropy=entry["g"],
                               Color=[s / scatters for s in entry["sigma_s"]]))
    return nodes.sum(parts)


def make_material(name, entry):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = Nodes(material.node_tree)
    output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    make = {"matte": matte, "coated": coated, "translucent": coated, "metal": metal, "glass": glass}
    shader = with_coat(nodes, entry, make[entry["kind"]](nodes, entry))
    material.node_tree.links.new(shader, output.inputs["Surface"])
    if entry["kind"] == "glass":
        volume = inside(nodes, entry)
        if volume is not None:
            material.node_tree.links.new(volume, output.inputs["Volume"])
            material.cycles.homogeneous_volume = True
    return material


def along_minus_z(direction):
    return Vector(direction).to_track_quat("-Z", "Y")


def make_light(name, entry, gain):
    power = [p * g for p, g in zip(entry["power"], gain)]
    largest = max(power)
    light = bpy.data.lights.new(name, entry["kind"])
    light.energy = largest
    light.color = [p / largest if largest > 0 else 0 for p in power]
    light.use_shadow = True
    light.cycles.max_bounces = 1024
    light.cycles.use_multiple_importance_sampling = True
    thing = bpy.data.objects.new(name, light)
    thing.rotation_mode = "QUATERNION"
    if entry["kind"] == "SUN":
        light.angle = 0
        thing.rotation_quaternion = along_minus_z([-c for c in entry["towards"]])
    else:
        thing.location = entry["position"]
        thing.visible_camera = True
    if entry["kind"] in ("POINT", "SPOT"):
        light.shadow_soft_size = entry["radius"]
    if entry["kind"] in ("AREA", "SPOT"):
        thing.rotation_quaternion = Quaternion(entry["rotation"])
    if entry["kind"] == "AREA":
        light.shape = entry["shape"]
        light.size = entry["size"][0]
        light.size_y = entry["size"][1]
        light.spread = math.pi
    if entry["kind"] == "SPOT":
        light.spot_size = entry["spot_size"]
        light.spot_blend = entry["spot_blend"]
    bpy.context.scene.collection.objects.link(thing)


def make_world(image):
    world = bpy.data.worlds.new("surroundings")
    world.use_nodes = True
    nodes = Nodes(world.node_tree)
    parts = []
    for entry in [SCENE["surroundings"][name] for name in image["surroundings"]]:
        color = [c * g for c, g in zip(entry["radiance"], image["gain"])]
        if "file" in entry:
            place = nodes.add("ShaderNodeTexCoord")
            place = nodes.add("ShaderNodeMapping", {"vector_type": "POINT"}, Rotation=(0, 0, -entry["rotation"]),
                              Vector=nodes.tree.nodes[-1].outputs["Generated"])
            picture = nodes.add("ShaderNodeTexEnvironment", {"image": load_picture(entry["file"]),
                                                             "interpolation": "Closest"}, Vector=place)
            color = nodes.add("ShaderNodeVectorMath", {"operation": "MULTIPLY"}, Vector=picture)
            nodes.tree.nodes[-1].inputs[1].default_value = [c * g for c, g in zip(entry["radiance"], image["gain"])]
        parts.append(nodes.add("ShaderNodeBackground", Color=color, Strength=1.0))
    output = world.node_tree.nodes.new("ShaderNodeOutputWorld")
    if parts:
        world.node_tree.links.new(nodes.sum(parts), output.inputs["Surface"])
    bpy.context.scene.world = world


def make_camera(entry):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "HORIZONTAL"
    data.clip_start, data.clip_end = entry["clip"]
    data.shift_x, data.shift_y = entry["shift"]
    if entry["orthographic"]:
        data.type = "ORTHO"
        data.ortho_scale = entry["ortho_scale"]
    else:
        data.sensor_width = entry["sensor_width_mm"]
        data.lens = entry["lens_mm"]
    if entry["aperture_radius"] > 0:
        data.dof.use_dof = True
        data.dof.focus_distance = entry["focus"]
        data.dof.aperture_fstop = data.lens * 1e-3 / (2 * entry["aperture_radius"])
    camera = bpy.data.objects.new("camera", data)
    camera.location = entry["location"]
    camera.rotation_mode = "QUATERNION"
    camera.rotation_quaternion = Quaternion(entry["rotation"])
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = entry["resolution"]
    render.resolution_percentage = 100
    render.pixel_aspect_x, render.pixel_aspect_y = entry["pixel_aspect"]


def build(image):
    for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.lights, bpy.data.cameras, bpy.data.materials):
        for thing in list(kind):
            kind.remove(thing)
    materials = {name: make_material(name, entry) for name, entry in SCENE["materials"].items()}
    meshes = {name: make_mesh(name, entry) for name, entry in SCENE["meshes"].items()}
    for entry in SCENE["objects"]:
        mesh = meshes[entry["mesh"]]
        thing = bpy.data.objects.new(entry["id"], mesh)
        if not mesh.materials:
            mesh.materials.append(None)
        thing.material_slots[0].link = "OBJECT"
        thing.material_slots[0].material = materials[entry["material"]]
        thing.location = entry["location"]
        thing.rotation_mode = "QUATERNION"
        thing.rotation_quaternion = Quaternion(entry["rotation"])
        bpy.context.scene.collection.objects.link(thing)
    for name in image["lights"]:
        make_light(name, SCENE["lights"][name], image["gain"])
    make_world(image)
    make_camera(image["camera"])


)py";

}  // namespace gonio::scene
