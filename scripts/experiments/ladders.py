"""Manifests and the table of the appearance ladders, for ladders.mk:

  mesh CASE DATA FILE              the stand-in's mesh as PLY
  truth CASE SEED                  the scene as it is; seeds differ in place, lamps, cameras and the material's numbers
  sprayed TRUTH                    the same with a matte yellow object, as if sprayed for a scanner
  empty TRUTH                      the same without the object, for masks by background
  disturbed PHOTOGRAPHS SEED [EMPTY]   what is believed before align, and the pictures of EMPTY beside the others
  rung CASE K ALIGNED PHOTOGRAPHS [LOWER]   the scene of a rung; LOWER is the rung below as explain fitted it
  table CASE...                    every rung with its errors and what explain said
"""
import json
import math
import os
import random
import struct
import sys

# Aluminium at red, green and blue (McPeak et al. 2015), as the thesis has it.
ETA, K = [1.04, 0.76, 0.49], [6.45, 5.73, 4.76]
ALUMINIUM = [((n - 1) ** 2 + k * k) / ((n + 1) ** 2 + k * k) for n, k in zip(ETA, K)]
F0 = ((1.54 - 1) / (1.54 + 1)) ** 2
PAPER = {"model": "diffuse", "albedo": [0.8, 0.8, 0.8]}


def free(value, low, high):
    return {"value": value, "free": True, "min": low, "max": high}


# Each rung: its name, the mechanism that the next rung adds (None: explain has none for it), and the surface.
# Numbers that explain fits are free; `numbers` are those that lower rungs found.
LADDERS = {
    "bunny": [
        ("diffuse", "surface.interface", lambda n: {"model": "diffuse", "albedo": free([0.5, 0.5, 0.5], 0, 1)}),
        ("interfaced", "surface.subsurface",
         lambda n: {"model": "coated-diffuse", "albedo": free([0.5, 0.5, 0.5], 0, 1), "f0": F0,
                    "alpha": free(0.2, 0.02, 0.6)}),
        ("dipole", "surface.directional-subsurface",
         lambda n: {"model": "coated-diffuse", "albedo": free([0.5, 0.5, 0.5], 0, 1), "f0": F0, "alpha": 0.2}),
        ("directional", "surface.print-slopes",
         lambda n: {"model": "directional-dipole", "eta": 1.54, "alpha": 0.2, **n}),
        ("varying", None, lambda n: {"model": "directional-dipole", "eta": 1.54, **n,
                                     "laws": {"alpha": {"law": "print-normal", "rho": 0.2, "s": 2.4}}}),
    ],
    "glass": [
        ("glass", "volume.absorption", lambda n: {"model": "dielectric", "eta": 1.54}),
        ("absorbing", "surface.roughness", lambda n: {"model": "dielectric", "eta": 1.54, **n}),
        ("rough", "surface.print-layers", lambda n: {"model": "dielectric", "eta": 1.54, "alpha": 0.15, **n}),
        ("layered", None, lambda n: {"model": "dielectric", "eta": 1.54, **n,
                                     "laws": {"alpha": {"law": "print-layers", "alpha_even": 0.15, "alpha_odd": 0.4,
                                                        "layer_m": 0.004}}}),
    ],
    "metal": [
        ("metal", "surface.roughness", lambda n: {"model": "glossy-metal", "f0": ALUMINIUM, "alpha": 0.0}),
        ("rough", "surface.polish", lambda n: {"model": "glossy-metal", "f0": ALUMINIUM, "alpha": free(0.3, 0.02, 1)}),
        ("curved", None, lambda n: {"model": "glossy-metal", "f0": ALUMINIUM,
                                    "laws": {"alpha": {"law": "polish-curvature", "rho": 0.22, "s": 4.5,
                                                       "curvature_per_m": 60}}}),
    ],
}
VIEWS = {"bunny": 1, "glass": 2, "metal": 4}
LAMPS = {"bunny": 3, "glass": 1, "metal": 4}


def product(p, q):
    a, b, c, d = p
    e, f, g, h = q
    return [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e]


def looking(eye, at):
    """World from camera, x right, y down, z forward."""
    z = [a - e for a, e in zip(at, eye)]
    n = math.hypot(*z)
    z = [v / n for v in z]
    x = [z[1], -z[0], 0]
    n = math.hypot(*x)
    x = [v / n for v in x]
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    return {"matrix": [[x[i], y[i], z[i], eye[i]] for i in range(3)] + [[0, 0, 0, 1]]}


def write_mesh(case, data, out):
    if case == "bunny":
        with open(os.path.join(data, "recordings/bunny.ply"), "rb") as f:
            content = f.read()
    else:  # flat and curved faces that meet in edges, 85 mm wide, on its lowest vertex
        points, faces = [], []
        with open(os.path.join(data, "print/meshes/fandisk.obj")) as f:
            for words in (line.split() for line in f):
                if words[:1] == ["v"]:
                    points.append([0.05 * float(w) for w in words[1:4]])
                if words[:1] == ["f"]:
                    faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
        lowest = min(p[2] for p in points)
        content = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\n"
                   f"property double y\nproperty double z\nelement face {len(faces)}\n"
                   "property list uchar int vertex_indices\nend_header\n").encode()
        content += b"".join(struct.pack("<3d", p[0], p[1], p[2] - lowest) for p in points)
        content += b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces)
    with open(out, "wb") as f:
        f.write(content)


def truth(case, seed):
    r = random.Random(f"{case} {seed}")
    turn = r.uniform(-0.4, 0.4)
    pose = {"rotation": [math.cos(turn), 0, 0, math.sin(turn)],
            "translation_m": [r.uniform(-0.005, 0.005), r.uniform(-0.005, 0.005), 0]}
    top = LADDERS[case][-1][2]
    if case == "bunny":
        numbers = {"sigma_a_per_m": [r.uniform(3, 8), r.uniform(15, 30), r.uniform(40, 80)],
                   "sigma_s_per_m": [r.uniform(700, 1400)] * 3}
    else:
        numbers = {"sigma_a_per_m": [r.uniform(1, 4), r.uniform(15, 30), r.uniform(30, 60)]}
    surface = top(numbers if case != "metal" else {})
    if case == "metal":
        surface = {"model": "conductor", "eta": ETA, "k": K, "laws": surface["laws"]}
    lights, images = {}, []
    start = r.uniform(0, 2 * math.pi)
    for l in range(LAMPS[case]):
        a = start + 2 * math.pi * (l + r.uniform(-0.1, 0.1)) / LAMPS[case]
        if LAMPS[case] == 1:
            a = -math.pi / 2 + r.choice([-1, 1]) * r.uniform(0.6, 1.0)
        lights[f"lamp-{l}"] = {"model": "point", "watt_per_sr": [1, 1, 1],
                               "position_m": [0.32 * math.cos(a), 0.32 * math.sin(a), r.uniform(0.38, 0.46)]}
    around = -math.pi / 2 + r.uniform(-0.2, 0.2)
    for v in range(VIEWS[case]):
        a = around + 2 * math.pi * v / 4
        eye = [0.42 * math.cos(a), 0.42 * math.sin(a), r.uniform(0.24, 0.3)]
        for l in range(LAMPS[case]):
            images.append({"id": f"view-{v}-lamp-{l}", "camera": "camera", "light": f"lamp-{l}", "response": "linear",
                           "noise": {"gain": 2500, "read": 0.0005},
                           "world_from_camera": looking(eye, [0, 0, 0.035])})
    return {"gonio": 1, "files": {"mesh": {"path": f"{case}.ply"}},
            "cameras": {"camera": {"model": "pinhole", "width_px": 200, "height_px": 160, "fx_px": 360, "fy_px": 360,
                                   "cx_px": 99.5, "cy_px": 79.5}},
            "meshes": {"object": {"file": "mesh"}, "paper": {"plane": {"size_m": [1.6, 1.6]}}},
            "surfaces": {"object": surface, "paper": PAPER}, "lights": lights,
            "objects": [{"id": "object", "mesh": "object", "surface": "object", "world_from_object": pose},
                        {"id": "paper", "mesh": "paper", "surface": "paper"}],
            "images": images}


def sprayed(document):
    document["surfaces"]["object"] = {"model": "diffuse", "albedo": [0.75, 0.6, 0.25]}
    return document


def empty(document):
    document["objects"] = [o for o in document["objects"] if o["id"] == "paper"]
    for image in document["images"]:
        image["id"] += "-empty"
    return document


def disturbed(document, seed, others):
    """What is believed before align: the object 5 degrees and 4 mm off, lamps 1 cm."""
    r = random.Random(f"disturbed {seed}")

    def some(length):
        v = [r.gauss(0, 1) for _ in range(3)]
        return [length * c / math.hypot(*v) for c in v]

    pose = document["objects"][0]["world_from_object"]
    half = math.radians(2.5)
    pose["rotation"] = product([math.cos(half)] + some(math.sin(half)), pose["rotation"])
    pose["translation_m"] = [a + b for a, b in zip(pose["translation_m"], some(0.004))]
    for light in document["lights"].values():
        light["position_m"] = [a + b for a, b in zip(light["position_m"], some(0.01))]
    document["surfaces"]["object"] = {"model": "diffuse", "albedo": [0.5, 0.5, 0.5]}
    if others:
        document["files"].update(others["files"])
        document["images"] += others["images"]
    document.pop("provenance", None)
    return document


def coefficients(albedo, path_m, eta):
    """Of the standard dipole (Jensen et al. 2001) that sends back so much, with so long a diffuse mean free path."""
    inside = -1.440 / eta ** 2 + 0.710 / eta + 0.668 + 0.0636 * eta
    jump = (1 + inside) / (1 - inside)
    low, high = 0.0, 1.0
    for _ in range(60):
        a = (low + high) / 2
        root = math.sqrt(3 * (1 - a))
        back = a / 2 * (1 + math.exp(-4 / 3 * jump * root)) * math.exp(-root)
        low, high = (a, high) if back < albedo else (low, a)
    a = min(low, 1 - 1e-6)
    per_m = 1 / (max(path_m, 1e-5) * math.sqrt(3 * (1 - a)))
    return (1 - a) * per_m, a * per_m


def rung(case, k, aligned, photographs, lower):
    """The place of the object and of the lamps by align, the pictures as photographed, and a surface. Of the true
    surface the absorption of the glass alone is taken, which explain cannot fit."""
    name, _, surface = LADDERS[case][k]
    numbers = {}
    if case == "glass":
        numbers = {"sigma_a_per_m": photographs["surfaces"]["object"]["sigma_a_per_m"]}
    if name == "directional":
        albedo = lower["surfaces"]["object"]["albedo"]["value"]
        spread = lower["mechanisms"]["surface.subsurface"]
        paths = [spread[f"mean_free_path_{c}_m"]["value"] for c in "rgb"]
        pairs = [coefficients(a, p, 1.54) for a, p in zip(albedo, paths)]
        numbers = {key: free([p[i] for p in pairs], 0, 1e6) for i, key in enumerate(["sigma_a_per_m", "sigma_s_per_m"])}
    if name == "varying" and case == "bunny":
        own = lower["surfaces"]["object"]
        numbers = {key: own[key] for key in ("sigma_a_per_m", "sigma_s_per_m")}
    document = {key: photographs[key] for key in ("gonio", "files", "cameras", "meshes", "surfaces", "images")}
    document.update({key: aligned[key] for key in ("lights", "objects")})
    document["surfaces"]["object"] = surface(numbers)
    for light in document["lights"].values():
        light["watt_per_sr"] = {"value": [1, 1, 1], "free": True, "share": "intensity"}
    if name == "dipole":  # as explain writes it, the only form that it fits; render makes a dipole of it
        paths = {f"mean_free_path_{c}_m": {"value": 0.003, "free": True, "min": 0, "max": 0.05} for c in "rgb"}
        document["mechanisms"] = {"surface.subsurface": {"on": "object", **paths}}
    return document


def mean(comparisons, key):
    return sum(c[key] for c in comparisons) / len(comparisons)


def answer(case, k):
    """What explain named at a rung, by all domains together; None where it could not answer or where none names
    anything and one says that a mismatch is unknown. And the same in words."""
    try:
        entries = read(f"run/{case}-{k}-explained.json")["explanations"]
    except OSError:
        with open(f"run/{case}-{k}-explained.txt") as f:
            return None, "failed: " + f.read().strip().splitlines()[-1]
    last = {e["domain"]: e for e in entries}  # earlier ones are of the fit
    named, words = [], []
    for domain, entry in last.items():
        own = [m["mechanism"] for m in entry["named"]]
        others = [o if isinstance(o, str) else " + ".join(o) for o in sum(entry["not_told_apart"], [])]
        others = [o for o in dict.fromkeys(others) if o not in own]
        text = domain + ": " + (" + ".join(own) or entry["verdict"]) + "".join(" or " + o for o in others)
        if "probability" in entry:
            text += f" ({100 * entry['probability']:.0f} %)"
        likely = [w for w in entry.get("weighed", []) if w["answer"] == "mechanisms"]
        if likely and not own:
            text += f", likeliest {' + '.join(likely[0]['mechanisms'])} ({100 * likely[0]['probability']:.0f} %)"
        named += own
        words.append(text)
    unknown = any(e["verdict"] == "unknown" for e in last.values())
    return (None if unknown and not named else named), "; ".join(words)


def table(cases):
    """RMSE has the noise of both pictures in it, z is over that noise. A rung is named rightly where explain
    names what the next rung adds, the top where it names nothing. Rungs whose next one adds what the library has no
    mechanism for count as not named; the count without them stands beside it."""
    print(f"{'case':6} {'rung':11} {'RMSE':>7} {'SSIM':>7} {'z rms':>7}   {'next rung':20} explain")
    right = asked = known = silent = 0
    for case in cases:
        for k, (name, wanted, _) in enumerate(LADDERS[case]):
            compared = read(f"run/{case}-{k}-compared.json")["comparisons"]
            named, words = answer(case, k)
            top = k == len(LADDERS[case]) - 1
            good = named is not None and (not named if top else wanted in named)
            silent += top and good
            right += good and not top
            asked += not top
            known += wanted is not None
            print(f"{case:6} {name:11} {mean(compared, 'rmse'):7.4f} {mean(compared, 'ssim'):7.4f} "
                  f"{mean(compared, 'z_rms'):7.2f} "
                  f"{'✓' if good else '✗'} {'(top)' if top else wanted or '(no mechanism)':20} {words}")
    print(f"next rung named: {right} of {asked}, of those that have a mechanism {right} of {known}; "
          f"nothing said at the top: {silent} of {len(cases)}")


def read(path):
    with open(path) as f:
        return json.load(f)


def main(command, *rest):
    if command == "mesh":
        write_mesh(*rest)
    elif command == "table":
        table(rest)
    else:
        documents = {"truth": lambda case, seed: truth(case, seed), "empty": lambda path: empty(read(path)),
                     "sprayed": lambda path: sprayed(read(path)),
                     "disturbed": lambda path, seed, others=None:
                     disturbed(read(path), seed, read(others) if others else None),
                     "rung": lambda case, k, aligned, photographs, lower=None:
                     rung(case, int(k), read(aligned), read(photographs), read(lower) if lower else None)}
        json.dump(documents[command](*rest), sys.stdout, indent=1)


if __name__ == "__main__":
    main(*sys.argv[1:])
