"""Surfaces as Cycles' nodes: the matte one that the manifest states, and what it is in truth. Run by Blender's Python.

Cycles' diffuse node at roughness 0 is Lambert's law; a coat is its glossy node (GGX, one facet) mixed in by the Fresnel
factor of the view. Its roughness is the root of GGX' alpha.
"""
import bpy


class Nodes:
    def __init__(self, material):
        material.use_nodes = True
        self.tree = material.node_tree
        self.tree.nodes.clear()

    def add(self, kind, settings=None, **inputs):
        node = self.tree.nodes.new("ShaderNode" + kind)
        for key, value in (settings or {}).items():
            setattr(node, key, value)
        for key, value in inputs.items():
            self.set(node.inputs[key.replace("_", " ")], value)
        return node

    def set(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif socket.type == "RGBA":
            socket.default_value = (*value, 1)
        else:
            socket.default_value = value

    def mix(self, share, one, other):
        node = self.tree.nodes.new("ShaderNodeMixShader")
        for socket, value in zip(node.inputs, (share, one, other)):
            self.set(socket, value)
        return node.outputs[0]

    def math(self, operation, a, b=0.0, c=0.0):
        node = self.add("Math", {"operation": operation})
        for socket, value in zip(node.inputs, (a, b, c)):
            self.set(socket, value)
        return node.outputs[0]

    def place(self, axis=None):
        """Position in the object's frame, m; or one coordinate of it."""
        position = self.add("TexCoord").outputs["Object"]
        return position if axis is None else self.add("SeparateXYZ", Vector=position).outputs[axis]

    def rising(self, axis, lower, upper):
        """0 below, 1 above, along an axis of the object."""
        node = self.add("MapRange", {"clamp": True}, Value=self.place(axis), From_Min=lower, From_Max=upper)
        return node.outputs[0]

    def bell(self, middle, width):
        away = self.add("VectorMath", {"operation": "DISTANCE"})
        self.set(away.inputs[0], self.place())
        away.inputs[1].default_value = middle
        d = self.math("DIVIDE", away.outputs["Value"], width)
        return self.math("EXPONENT", self.math("MULTIPLY", self.math("MULTIPLY", d, d), -0.5))


def diffuse(nodes, colour, roughness=0.0, **more):
    return nodes.add("BsdfDiffuse", Color=colour, Roughness=roughness, **more).outputs[0]


def coat(nodes, base, effect, roughness, share=None):
    fresnel = nodes.add("Fresnel", IOR=effect["index"]).outputs[0]
    if share is not None:
        fresnel = nodes.math("MULTIPLY", fresnel, share)
    if effect["name"] == "anisotropic_gloss":
        gloss = nodes.add(
            "BsdfAnisotropic",
            {"distribution": "GGX"},
            Color=(1, 1, 1),
            Roughness=roughness,
            Anisotropy=effect["anisotropy"],
            Rotation=effect["rotation"],
            Tangent=nodes.add("Tangent", {"direction_type": "RADIAL", "axis": "Z"}).outputs[0],
        )
    else:
        gloss = nodes.add("BsdfGlossy", {"distribution": "GGX"}, Color=(1, 1, 1), Roughness=roughness)
    return nodes.mix(fresnel, base, gloss.outputs[0])


def shader(nodes, colour, effect, box):
    """`box`: lowest and highest corner of the object in its own frame, and `at`, a place on it."""
    if effect is None:
        return diffuse(nodes, colour)
    name, (low, high, at) = effect["name"], box
    size = max(h - l for l, h in zip(low, high))
    if name in ("clear_coat", "anisotropic_gloss"):
        return coat(nodes, diffuse(nodes, colour), effect, effect["roughness"])
    if name in ("coat_part", "roughness_varying"):
        axis = effect["axis"]
        if name == "coat_part":
            edge = low[axis] + effect["from"] * (high[axis] - low[axis])
            return coat(
                nodes, diffuse(nodes, colour), effect, effect["roughness"], nodes.rising(axis, edge, edge + 1e-5)
            )
        rough = nodes.rising(axis, low[axis], high[axis])
        rough = nodes.math("MULTIPLY_ADD", rough, effect["roughness_to"] - effect["roughness"], effect["roughness"])
        return coat(nodes, diffuse(nodes, colour), effect, rough)
    if name == "metal":
        gloss = nodes.add(
            "BsdfGlossy",
            {"distribution": "MULTI_GGX"},
            Color=[0.3 + 0.6 * c for c in colour],
            Roughness=effect["roughness"],
        )
        return nodes.mix(effect["share"], diffuse(nodes, colour), gloss.outputs[0])
    if name == "velvet":
        cloth = nodes.add("BsdfVelvet", Color=[0.3 + 0.6 * c for c in colour], Sigma=effect["sigma"])
        return nodes.mix(effect["share"], diffuse(nodes, colour), cloth.outputs[0])
    if name == "oren_nayar":
        return diffuse(nodes, colour, effect["roughness"])
    if name == "subsurface":
        return nodes.add(
            "SubsurfaceScattering", {"falloff": "RANDOM_WALK"}, Color=colour, Scale=1.0, Radius=effect["radius_m"]
        ).outputs[0]
    if name == "translucent_sheet":
        through = nodes.add("BsdfTranslucent", Color=colour).outputs[0]
        return nodes.mix(effect["share"], diffuse(nodes, colour), through)
    if name == "stain":
        factor = nodes.math("MULTIPLY_ADD", nodes.bell(at, effect["width"] * size), -effect["depth"], 1.0)
        mixed = nodes.add("VectorMath", {"operation": "SCALE"}, Scale=factor)
        mixed.inputs[0].default_value = colour
        return diffuse(nodes, mixed.outputs[0])
    if name == "bump":
        noise = nodes.add("TexNoise", Vector=nodes.place(), Scale=1 / effect["wave_m"], Detail=2.0)
        bent = nodes.add("Bump", Strength=1.0, Distance=effect["height_m"], Height=noise.outputs[0])
        return diffuse(nodes, colour, Normal=bent.outputs[0])
    raise ValueError(name)


def material(colour, effect, box, number):
    made = bpy.data.materials.new("surface")
    made.pass_index = number
    nodes = Nodes(made)
    output = nodes.tree.nodes.new("ShaderNodeOutputMaterial")
    nodes.set(output.inputs["Surface"], shader(nodes, colour, effect, box))
    return made


def fog(effect):
    """Of a body of air: extinction `per_m`, of which `albedo` is scattered."""
    made = bpy.data.materials.new("air")
    nodes = Nodes(made)
    output = nodes.tree.nodes.new("ShaderNodeOutputMaterial")
    sigma, white = effect["per_m"], effect["albedo"]
    parts = nodes.tree.nodes.new("ShaderNodeAddShader")
    nodes.set(parts.inputs[0], nodes.add("VolumeScatter", Color=(1, 1, 1), Density=sigma * white).outputs[0])
    nodes.set(parts.inputs[1], nodes.add("VolumeAbsorption", Color=(0, 0, 0), Density=sigma * (1 - white)).outputs[0])
    nodes.set(output.inputs["Volume"], parts.outputs[0])
    made.cycles.homogeneous_volume = True
    return made
