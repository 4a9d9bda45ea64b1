"""One case of scripts/prove wild from its seed: scene, cameras, lamps, pictures, noise, and what the manifest will not
say. Pure Python, so that the draw is the same wherever it runs. Lengths in metres; the ground is z = 0, +z is up.
"""
import math
import random

import effects

MESHES = (  # how each is built stands in meshes.py; the drawn number makes each one of a kind
    "ball",
    "monkey",
    "torus",
    "cone",
    "cylinder",
    "cube",
    "rounded_cube",
    "dome",
    "stone",
    "potato",
    "star_blob",
    "dunes",
    "crumpled",
    "bitten_cube",
    "bitten_ball",
    "pierced_cylinder",
    "cross",
    "hollow_half",
    "vase",
    "bowl",
    "goblet",
    "bottle",
    "pawn",
    "bell",
    "letter_g",
    "letter_8",
    "letter_and",
    "letter_r",
    "bunny",
    "superellipsoid",
    "harmonics",
    "knot",
    "spring",
    "gear",
    "star",
    "stairs",
    "cage",
    "bundle",
    "drops",
    "sheet",
    "twisted_bar",
    "shell",
)


def sphere_point(rng, lowest, highest):
    """Azimuth anywhere, elevation between two angles: a unit vector."""
    azimuth, elevation = rng.uniform(-math.pi, math.pi), rng.uniform(lowest, highest)
    return [math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)]


def colour(rng, lower, upper):
    """An albedo: mostly pale, sometimes with a clear hue."""
    grey, tint = rng.uniform(lower, upper), rng.choice((0.05, 0.15, 0.4))
    return [min(0.85, max(0.04, grey * (1 + tint * rng.uniform(-1, 1)))) for _ in range(3)]


def draw_objects(rng):
    count = rng.choice((1, 1, 1, 2, 2, 3, 4))
    size = {1: (0.10, 0.15), 2: (0.08, 0.12), 3: (0.06, 0.10), 4: (0.055, 0.085)}[count]
    objects, places = [], []
    while len(objects) < count:
        own = rng.uniform(*size)
        reach = 0.0 if count == 1 else 0.13
        x, y = rng.uniform(-reach, reach), rng.uniform(-reach, reach)
        if any(math.hypot(x - a, y - b) < 0.55 * (own + other) for a, b, other in places):
            continue
        places.append((x, y, own))
        objects.append(
            {
                "mesh": {"kind": rng.choice(MESHES), "number": rng.randrange(10**6)},
                "size_m": own,
                "x": x,
                "y": y,
                "turn": rng.uniform(-math.pi, math.pi),
                "albedo": colour(rng, 0.15, 0.75),
                "flat": rng.random() < 0.25,
            }
        )
    return objects


def draw_cameras(rng):
    count = rng.choice((2, 2, 2, 3, 3, 3, 4, 5))
    width = rng.choice((96, 104, 112, 120) if count < 4 else (96, 104))
    height = 4 * (int(width * rng.choice((0.7, 0.75, 0.8))) // 4)
    distance, field = rng.uniform(0.5, 0.75), rng.uniform(0.3, 0.42)
    focal = width * distance / field
    cameras, start = [], rng.uniform(-1.1, 0.2)
    for i in range(count):
        azimuth = start + i * rng.uniform(0.9, 1.1) * 1.6 / count
        elevation = rng.uniform(0.35, 0.95)
        out = distance * rng.uniform(0.93, 1.07)
        target = [rng.uniform(-0.015, 0.015), rng.uniform(-0.015, 0.015), rng.uniform(0.02, 0.05)]
        cameras.append(
            {
                "position_m": [
                    target[0] + out * math.cos(elevation) * math.sin(azimuth),
                    target[1] - out * math.cos(elevation) * math.cos(azimuth),
                    target[2] + out * math.sin(elevation),
                ],
                "target_m": target,
                "roll_rad": rng.uniform(-0.06, 0.06),
                "width": width,
                "height": height,
                "focal_px": focal,
            }
        )
    return cameras


def camera_axes(camera):
    """Columns of the rotation from camera (x right, y down, z forward) to world."""
    forward = unit([t - p for t, p in zip(camera["target_m"], camera["position_m"])])
    right = unit(cross(forward, [0, 0, 1]))
    down = cross(forward, right)
    c, s = math.cos(camera["roll_rad"]), math.sin(camera["roll_rad"])
    return ([c * r + s * d for r, d in zip(right, down)], [c * d - s * r for r, d in zip(right, down)], forward)


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def in_view(point, camera, margin_px):
    x, y, z = (dot([p - q for p, q in zip(point, camera["position_m"])], axis) for axis in camera_axes(camera))
    if z <= 0.02:
        return False
    f = camera["focal_px"]
    return abs(f * x / z) < camera["width"] / 2 + margin_px and abs(f * y / z) < camera["height"] / 2 + margin_px


def behind_a_wall(towards, place, kind, walls):
    """Or within a hand's breadth of one."""
    if kind == "sun":
        return (walls > 0 and towards[1] > 0.3) or (walls > 1 and towards[0] < -0.3)
    return (walls > 0 and place[1] > 0.2) or (walls > 1 and place[0] < -0.24)


def draw_lamps(rng, cameras, walls):
    count, lamps = rng.choice((1, 2, 2, 2, 3, 3, 4)), []
    equal = rng.random() < 0.6  # one make of lamp: one free intensity for all
    kind = rng.choice(("point",) * 6 + ("sphere", "sun", "mixed", "mixed"))
    while len(lamps) < count:
        own = rng.choice(("point", "sphere", "sun")) if kind == "mixed" else kind
        towards = sphere_point(rng, 0.5, 1.3)
        if any(dot(towards, other["towards"]) > 0.94 for other in lamps):
            continue
        place = [rng.uniform(0.38, 0.7) * t for t in towards]
        if behind_a_wall(towards, place, own, walls):
            continue
        if own != "sun" and (any(in_view(place, c, 25) for c in cameras) or place[2] < 0.2):
            continue
        lamps.append(
            {
                "kind": own,
                "towards": towards,
                "position_m": place,
                "radius_m": rng.uniform(0.006, 0.02) if own == "sphere" else 0.0,
                "power": 1.0 if equal else rng.uniform(0.6, 1.6),
                "colour": [1.0, 1.0, 1.0] if equal else [rng.uniform(0.85, 1.15) for _ in range(3)],
            }
        )
    return lamps, equal and all(lamp["kind"] != "sun" for lamp in lamps)


def draw_pictures(rng, cameras, lamps):
    """Which camera, which lamps, which exposure; at least four, at most sixteen."""
    states = [[i] for i in range(len(lamps))]
    if len(lamps) > 1 and rng.random() < 0.3:
        states.append(list(range(len(lamps))))
    if len(lamps) > 2 and rng.random() < 0.3:
        states = [sorted(rng.sample(range(len(lamps)), 2)) for _ in range(2)] + states[:1]
    exposures = (
        [1.0, rng.choice((0.25, 0.4, 0.5))]
        if len(cameras) * len(states) < 4 or (len(cameras) * len(states) <= 8 and rng.random() < 0.3)
        else [1.0]
    )
    pictures = [
        {"camera": c, "lamps": s, "exposure": e} for c in range(len(cameras)) for s in states for e in exposures
    ]
    order = list(range(len(pictures)))
    rng.shuffle(order)
    for when, at in enumerate(order):
        pictures[at]["time_s"] = 5.0 * when + rng.uniform(0, 1)
    while len(pictures) > 16:
        del pictures[rng.randrange(len(pictures))]
    return pictures


def draw_distractors(rng):
    """Dust, noise stated a little wrong, lamps measured to a few mm, exposures that are known to a per cent."""
    found = []
    if rng.random() < 0.5:
        found.append({"name": "dust", "count": rng.randint(2, 6), "depth": rng.uniform(0.02, 0.12)})
    if rng.random() < 0.4:
        found.append({"name": "noise", "factor": rng.choice((0.9, 0.95, 1.05, 1.1))})
    if rng.random() < 0.5:
        found.append({"name": "lamps", "sigma_m": rng.uniform(0.0005, 0.0015)})
    if rng.random() < 0.3:
        found.append({"name": "gains", "sigma": 0.005})
    return found or [{"name": "dust", "count": 4, "depth": 0.05}]


KINDRED = (  # effects that are one for whoever explains
    {"tone_power", "tone_srgb", "tone_film"},
    {"veiling_glare", "bloom"},
    {"lamp_position", "one_lamp_misplaced", "lamp_direction"},
    {"spot_cone", "lobe"},
    {"clear_coat", "coat_part", "roughness_varying", "anisotropic_gloss"},
    {"second_lamp", "card"},
)


def strange_together(one, two):
    """Two effects that would be one, or two surfaces of one body."""
    both = {one["name"], two["name"]}
    if len(both) == 1 or any(both <= kin for kin in KINDRED):
        return True
    same_body = one.get("body") is not None and one.get("body") == two.get("body")
    return same_body and both <= effects.MATERIAL_NAMES


def dealt(seed):
    """Names of the effects of a seed. Dealt from shuffled decks, so that any hundred seeds hold a third nulls, a sixth
    pairs, and every effect about twice, and no seed says by its number what it holds."""
    slots = 0
    for block in range((seed - 1) // 12 + 1):
        counts = [0] * 4 + [1] * 6 + [2] * 2
        random.Random(f"gonio wild counts {block}").shuffle(counts)
        for place, count in enumerate(counts):
            if 12 * block + place + 1 == seed:
                return [card_of(slots + k) for k in range(count)]
            slots += count
    return []


def card_of(slot):
    names = sorted(effects.ALL)
    random.Random(f"gonio wild deck {slot // len(names)}").shuffle(names)
    return names[slot % len(names)]


def draw_scene(rng, seed):
    plan = {"seed": seed, "objects": draw_objects(rng), "cameras": draw_cameras(rng)}
    plan["walls"] = rng.choice((0, 0, 1, 2))
    plan["ground_albedo"] = colour(rng, 0.2, 0.65)
    plan["ground_known"] = rng.random() < 0.4
    plan["wall_albedo"] = colour(rng, 0.2, 0.65)
    plan["lamps"], plan["lamps_equal"] = draw_lamps(rng, plan["cameras"], plan["walls"])
    plan["pictures"] = draw_pictures(rng, plan["cameras"], plan["lamps"])
    # of the sensor alone, at half of the largest proper reading
    relative = effects.log_uniform(rng, 0.008, 0.02)
    plan["noise"] = {"gain": 0.5 / (0.5 * relative) ** 2, "read": effects.log_uniform(rng, 0.0005, 0.003)}
    return plan


def draw(seed):
    rng = random.Random(f"gonio wild {seed}")
    names = dealt(seed)
    while True:  # until the scene can have them
        plan = draw_scene(rng, seed)
        plan["effects"] = [effects.draw_effect(rng, plan, name) for name in names]
        if None in plan["effects"] or (len(names) == 2 and strange_together(*plan["effects"])):
            names = names if None in plan["effects"] else [names[0], rng.choice(sorted(effects.ALL))]
            continue
        wants = 0.25 if names else 0.55
        plan["distractors"] = draw_distractors(rng) if rng.random() < wants else []
        return plan
