"""What can be wrong with a recording: every effect, and how its numbers are drawn. Pure Python; what an effect does
stands in camera_chain.py (pictures), scene.py (lamps, cameras, shapes) and materials.py.

An effect is drawn as a dictionary {"name": ..., numbers}. Which names count for it stands in library.py: nothing that
is drawn depends on the library.
"""


import math


def log_uniform(rng, lower, upper):
    return math.exp(rng.uniform(math.log(lower), math.log(upper)))


def size(rng, lower, upper):
    """Of an effect: from what nobody sees to what nobody overlooks, the larger half twice as often."""
    return lower * (upper / lower) ** (rng.random() ** 0.6)


def sign(rng):
    return rng.choice((-1, 1))


def direction(rng):
    z, phi = rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi)
    across = math.sqrt(1 - z * z)
    return [across * math.cos(phi), across * math.sin(phi), z]


def times(factor, vector):
    return [factor * x for x in vector]


def bodies(plan):
    """Places of the objects that stand on the ground, ground and walls apart."""
    return range(len(plan["objects"]))


def a_body(rng, plan):
    return rng.choice(list(bodies(plan)))


def corner(plan):
    """Largest distance from the axis, over the focal length."""
    c = plan["cameras"][0]
    return math.hypot(c["width"] / 2, c["height"] / 2) / c["focal_px"]


def a_lamp(rng, plan, kinds):
    chosen = [i for i, lamp in enumerate(plan["lamps"]) if lamp["kind"] in kinds]
    return rng.choice(chosen) if chosen else None


# --- the camera's chain: numbers in pixels or of the largest proper reading, which is about one


def lens_radial(rng, plan):
    px, r, f = sign(rng) * size(rng, 0.08, 4), corner(plan), plan["cameras"][0]["focal_px"]
    return {"k1": px / (f * r**3), "k2": rng.choice((0, 0, -0.4)) * px / (f * r**5)}


def lens_tangential(rng, plan):
    px, r, f = size(rng, 0.08, 3), corner(plan), plan["cameras"][0]["focal_px"]
    turn = rng.uniform(0, 2 * math.pi)
    return {"p1": px * math.cos(turn) / (2 * f * r * r), "p2": px * math.sin(turn) / (2 * f * r * r)}


def focal_length(rng, plan):
    return {"growth": sign(rng) * size(rng, 0.0008, 0.03)}


def principal_point(rng, plan):
    px, turn = size(rng, 0.05, 3), rng.uniform(0, 2 * math.pi)
    return {"x_px": px * math.cos(turn), "y_px": px * math.sin(turn)}


def pixel_aspect(rng, plan):
    return {"growth_y": sign(rng) * size(rng, 0.001, 0.03)}


def rolling_shutter(rng, plan):
    return {"px": sign(rng) * size(rng, 0.1, 4)}


def lateral_colour(rng, plan):
    px = size(rng, 0.06, 1.5)
    scale = px / (corner(plan) * plan["cameras"][0]["focal_px"])
    return {"red": sign(rng) * scale, "blue": -sign(rng) * scale * rng.uniform(0.5, 1.5)}


def vignetting(rng, plan):
    return {"falloff": size(rng, 0.004, 0.35), "law": rng.choice(("square", "cosine"))}


def black_offset(rng, plan):
    return {"offset": sign(rng) * size(rng, 0.0005, 0.03)}


def tone_power(rng, plan):
    return {"gamma": 1 + sign(rng) * size(rng, 0.008, 0.3)}


def tone_srgb(rng, plan):
    return {"share": size(rng, 0.02, 1)}


def tone_film(rng, plan):
    return {"contrast": size(rng, 0.02, 1)}


def saturation(rng, plan):
    return {"at": rng.uniform(0.35, 0.95)}  # of the largest proper reading


def veiling_glare(rng, plan):
    return {"share": size(rng, 0.003, 0.12)}


def bloom(rng, plan):
    return {"share": size(rng, 0.005, 0.15), "radius_px": log_uniform(rng, 1.5, 12)}


def crosstalk(rng, plan):
    return {"share": size(rng, 0.004, 0.15)}


def fixed_pattern(rng, plan):
    return {"sigma": size(rng, 0.002, 0.06)}


def flicker_rows(rng, plan):
    return {"amplitude": size(rng, 0.003, 0.2), "period_px": log_uniform(rng, 8, 60)}


def exposure_error(rng, plan):
    return {"relative": sign(rng) * size(rng, 0.005, 0.2), "count": rng.choice((1, 1, 2))}


def drift(rng, plan):
    return {"amplitude": sign(rng) * size(rng, 0.005, 0.2), "time_constant_s": log_uniform(rng, 40, 300)}


# --- cameras and lamps: metres, radians


def camera_nudged(rng, plan):
    f = plan["cameras"][0]["focal_px"]
    px = size(rng, 0.15, 5)
    return {
        "camera": rng.randrange(len(plan["cameras"])),
        "turn": times(px / f, direction(rng)),
        "shift_m": times(0.3 * px / f * rng.random(), direction(rng)),
    }


def defocus(rng, plan):
    return {"aperture_radius_m": size(rng, 0.0004, 0.012), "focus": rng.uniform(0.75, 1.3)}


def lamp_position(rng, plan):
    if a_lamp(rng, plan, ("point", "sphere")) is None or len(plan["lamps"]) < 2:
        return None
    return {"shift_m": times(size(rng, 0.004, 0.08), direction(rng))}


def one_lamp_misplaced(rng, plan):
    lamp = a_lamp(rng, plan, ("point", "sphere"))
    if lamp is None:
        return None
    return {"lamp": lamp, "shift_m": times(size(rng, 0.004, 0.1), direction(rng))}


def lamp_direction(rng, plan):
    lamp = a_lamp(rng, plan, ("sun",))
    return None if lamp is None else {"lamp": lamp, "turn": times(size(rng, 0.01, 0.25), direction(rng))}


def finite_size(rng, plan):
    if a_lamp(rng, plan, ("point", "sun")) is None:
        return None
    return {"radius_m": size(rng, 0.004, 0.07), "sun_rad": size(rng, 0.01, 0.15)}


def spot_cone(rng, plan):
    if a_lamp(rng, plan, ("point",)) is None:
        return None
    return {
        "outer": log_uniform(rng, 0.9, 3),
        "blend": rng.uniform(0.2, 1),  # outer: of the scene's half angle
        "aside": times(0.05 * rng.random(), direction(rng)),
    }


def lobe(rng, plan):
    if a_lamp(rng, plan, ("point",)) is None:
        return None
    return {"exponent": size(rng, 0.1, 8)}


def second_lamp(rng, plan):
    return {
        "share": size(rng, 0.003, 0.2),
        "azimuth": rng.uniform(-math.pi, math.pi),
        "elevation": rng.uniform(0.4, 1.3),
        "far": rng.random() < 0.4,
    }


def card(rng, plan):
    lamp = a_lamp(rng, plan, ("point",))
    if lamp is None:
        return None
    return {
        "lamp": lamp,
        "distance_m": log_uniform(rng, 0.05, 0.3),
        "size_m": log_uniform(rng, 0.1, 0.35),
        "albedo": rng.uniform(0.5, 0.9),
        "turn": rng.uniform(0, 2 * math.pi),
    }


def ambient(rng, plan):
    return {
        "share": size(rng, 0.002, 0.2),
        "colour": [rng.uniform(0.7, 1.3) for _ in range(3)],
        "from_above": rng.random() < 0.3,
    }


# --- surfaces: `body` is the object


def clear_coat(rng, plan):
    return {"body": a_body(rng, plan), "index": rng.uniform(1.25, 1.8), "roughness": log_uniform(rng, 0.3, 0.75)}


def coat_part(rng, plan):
    return {**clear_coat(rng, plan), "from": rng.uniform(0.35, 0.65), "axis": rng.choice((0, 2))}


def roughness_varying(rng, plan):
    return {
        **clear_coat(rng, plan),
        "roughness": 0.3,
        "roughness_to": rng.uniform(0.45, 0.8),
        "axis": rng.choice((0, 2)),
    }


def metal(rng, plan):
    return {"body": a_body(rng, plan), "roughness": rng.uniform(0.35, 0.8), "share": size(rng, 0.05, 1)}


def velvet(rng, plan):
    return {"body": a_body(rng, plan), "share": size(rng, 0.02, 0.6), "sigma": rng.uniform(0.2, 0.9)}


def oren_nayar(rng, plan):
    return {"body": a_body(rng, plan), "roughness": size(rng, 0.05, 1)}


def anisotropic_gloss(rng, plan):
    return {**clear_coat(rng, plan), "anisotropy": rng.uniform(0.5, 0.85), "rotation": rng.random()}


def subsurface(rng, plan):
    return {"body": a_body(rng, plan), "radius_m": times(size(rng, 0.001, 0.03), [1, 0.6, 0.4])}


def translucent_sheet(rng, plan):
    sheets = [i for i in bodies(plan) if plan["objects"][i]["mesh"]["kind"] == "sheet"]
    return {"body": sheets[0], "share": size(rng, 0.01, 0.6)} if sheets else None


def stain(rng, plan):
    return {
        "body": a_body(rng, plan),
        "depth": size(rng, 0.02, 0.7),
        "width": log_uniform(rng, 0.06, 0.3),
        "at": rng.random(),
    }


def bump(rng, plan):
    return {"body": a_body(rng, plan), "height_m": size(rng, 0.00005, 0.003), "wave_m": log_uniform(rng, 0.006, 0.03)}


# --- shapes and the air


def pose(rng, plan):
    return {
        "body": a_body(rng, plan),
        "shift_m": times(size(rng, 0.0003, 0.012), direction(rng)),
        "turn_rad": times(size(rng, 0.002, 0.08), direction(rng)),
    }


def scale(rng, plan):
    return {"body": a_body(rng, plan), "growth": sign(rng) * size(rng, 0.003, 0.1)}


def missing_object(rng, plan):
    return {
        "size_m": size(rng, 0.006, 0.05),
        "mesh": rng.choice(("ball", "cube", "cone", "cylinder")),
        "x": rng.uniform(-0.12, 0.12),
        "y": rng.uniform(-0.12, 0.12),
        "albedo": rng.uniform(0.1, 0.8),
    }


def dent(rng, plan):
    return {
        "body": a_body(rng, plan),
        "depth": size(rng, 0.003, 0.12),
        "width": rng.uniform(0.1, 0.3),
        "at": rng.random(),
    }


def fog(rng, plan):
    return {"per_m": size(rng, 0.01, 0.8), "albedo": rng.uniform(0.6, 0.95)}


LENS = [lens_radial, lens_tangential, focal_length, principal_point, pixel_aspect, rolling_shutter, lateral_colour]
CHAIN = [
    vignetting,
    black_offset,
    tone_power,
    tone_srgb,
    tone_film,
    saturation,
    veiling_glare,
    bloom,
    crosstalk,
    fixed_pattern,
    flicker_rows,
    exposure_error,
    drift,
]
SCENE = [
    camera_nudged,
    defocus,
    lamp_position,
    one_lamp_misplaced,
    lamp_direction,
    finite_size,
    spot_cone,
    lobe,
    second_lamp,
    card,
    ambient,
    clear_coat,
    coat_part,
    roughness_varying,
    metal,
    velvet,
    oren_nayar,
    anisotropic_gloss,
    subsurface,
    translucent_sheet,
    stain,
    bump,
    pose,
    scale,
    missing_object,
    dent,
    fog,
]
ALL = {f.__name__: f for f in LENS + CHAIN + SCENE}
LENS_NAMES = {f.__name__ for f in LENS}
CHAIN_NAMES = {f.__name__ for f in CHAIN} | LENS_NAMES
MATERIAL_NAMES = {
    f.__name__
    for f in (
        clear_coat,
        coat_part,
        roughness_varying,
        metal,
        velvet,
        oren_nayar,
        anisotropic_gloss,
        subsurface,
        translucent_sheet,
        stain,
        bump,
    )
}


def draw_effect(rng, plan, name):
    """A dictionary, or nothing where these recordings cannot have the effect."""
    numbers = ALL[name](rng, plan)
    return None if numbers is None else {"name": name, **numbers}
