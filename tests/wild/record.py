"""Records cases of scripts/prove wild:
    blender -b --factory-startup -noaudio -P record.py -- CASES TRUTHS BUNNY.ply SEED...

CASES/NNN/: recording.json and its files, all that explain is given. TRUTHS/NNN.json: what was left out, how strong it
is; TRUTHS/NNN.effect: change of each reading after the fair refit, in noise widths, 32 bit, picture after picture.
A case whose truth is there is not made again.
"""
import hashlib
import json
import math
import os
import random
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import camera_chain
import draw
import effects
import exr
import library
import manifest
import meshes
import scene
import strength

SAMPLES = 64  # of each half and all lamps together, of what is recorded; a quarter of what it is held against


def generator(seed, word):
    return np.random.default_rng(
        int.from_bytes(hashlib.sha256(f"gonio wild {seed} {word}".encode()).digest()[:8], "big")
    )


class Recorder:
    def __init__(self, plan, scratch):
        self.plan, self.scratch, self.made = plan, scratch, {}
        self.lens = any(e["name"] in effects.LENS_NAMES for e in plan["effects"])
        self.dust = {}
        self.scale, self.largest = 1.0, 1.0

    def version(self, names, errors=True):
        """(shapes, views) with these effects of the scene, rendered once."""
        key = (tuple(sorted(names)), errors)
        if key not in self.made:
            plan = dict(self.plan, effects=[e for e in self.plan["effects"] if e["name"] in names])
            if not errors:
                plan["lamp_errors"] = None
            samples = SAMPLES if not self.made else SAMPLES // 4
            if self.lens or any(e["name"] == "fog" for e in plan["effects"]):
                samples *= 2
            shapes, views = scene.renderings(plan, samples, self.scratch, self.lens, not self.made)
            self.made[key] = shapes, [self.seen(v) for v in views]
        return self.made[key]

    def seen(self, view):
        if self.lens and "surface" in view:  # surfaces at the pixels' middles; radiance stays fine until a lens is chosen
            n, m = camera_chain.FINE, camera_chain.MARGIN_PX
            inner = view["surface"][n * m : -n * m, n * m : -n * m]
            view["surface"] = inner[n // 2 :: n, n // 2 :: n]
        return view

    def radiance(self, views, picture, half, lenses):
        """{lamp: picture} of what shines in it."""
        view, camera = views[picture["camera"]], self.plan["cameras"][picture["camera"]]
        here = {g: takes[picture["number"]] for g, takes in view.items() if g != "surface" and picture["number"] in takes}
        found = {g: both[half] if half is not None else 0.5 * (both[0] + both[1]) for g, both in here.items()}
        if self.lens:
            found = {g: camera_chain.through_lens(v, camera, lenses) for g, v in found.items()}
        return found

    def readings(self, names, half, errors=True, known_wrong=True):
        """Noise-free readings of all pictures with the effects of these names; None for half: both."""
        on_scene = [n for n in names if n not in effects.CHAIN_NAMES]
        _, views = self.version(on_scene, errors)
        chain = [e for e in self.plan["effects"] if e["name"] in names and e["name"] in effects.CHAIN_NAMES]
        lenses = [e for e in chain if e["name"] in effects.LENS_NAMES]
        chain = chain + ([d for d in self.plan["distractors"] if "factor_of" in d] if known_wrong else [])
        result = []
        for picture in self.plan["pictures"]:
            radiance = sum(self.radiance(views, picture, half, lenses).values()) * self.scale * picture["exposure"]
            result.append(camera_chain.as_recorded(radiance, None, picture, self.plan, chain))
        return result


def complete(plan):
    """Numbers of effects that need the pictures' number and size: phases, patterns, which pictures."""
    for number, picture in enumerate(plan["pictures"]):
        picture["number"], picture["id"] = number, f"p{number:02d}"
    size = plan["cameras"][0]["height"], plan["cameras"][0]["width"], 1
    rng = random.Random(f"gonio wild details {plan['seed']}")
    for e in plan["effects"] + plan["distractors"]:
        if e["name"] == "flicker_rows":
            e["phases"] = [rng.uniform(0, 2 * math.pi) for _ in plan["pictures"]]
        elif e["name"] == "exposure_error":
            e["pictures"] = rng.sample(range(len(plan["pictures"])), min(e["count"], len(plan["pictures"]) - 1))
        elif e["name"] == "fixed_pattern":
            pattern = 1 + e["sigma"] * generator(plan["seed"], "pattern").standard_normal((*size[:2], 3))
            e["factor_of"] = lambda picture, pattern=pattern: pattern
        elif e["name"] == "dust":
            pattern = dusty(rng, e, size)
            e["factor_of"] = lambda picture, pattern=pattern: pattern
        elif e["name"] == "gains":
            factors = [1 + e["sigma"] * rng.gauss(0, 1) for _ in plan["pictures"]]
            e["factor_of"] = lambda picture, factors=factors: factors[picture["number"]]
        elif e["name"] == "lamps":
            plan["lamp_errors"] = [[e["sigma_m"] * rng.gauss(0, 1) for _ in range(3)] for _ in plan["lamps"]]


def dusty(rng, dust, size):
    y, x = np.mgrid[: size[0], : size[1]]
    pattern = np.ones(size)
    for _ in range(dust["count"]):
        r2 = (x - rng.uniform(0, size[1])) ** 2 + (y - rng.uniform(0, size[0])) ** 2
        pattern *= (1 - dust["depth"] * np.exp(-r2 / (2 * rng.uniform(0.5, 1.5) ** 2)))[:, :, None]
    return pattern


def stated_noise(plan, halves, mean):
    """What the manifest says of a picture: the sensor's noise and the renderer's, its variance a line in the value."""
    variance, value = ((halves[0] - halves[1]) ** 2 / 4).ravel(), np.maximum(mean, 0).ravel()
    edge = np.quantile(variance, 0.99)  # silhouettes are few
    variance = np.minimum(variance, edge)
    slope = max(0.0, np.cov(value, variance)[0, 1] / max(np.var(value), 1e-12))
    slope = min(slope, variance.mean() / max(value.mean(), 1e-9))
    own = plan["noise"]
    wrong = next((d["factor"] for d in plan["distractors"] if d["name"] == "noise"), 1.0)
    gain = 1 / (1 / own["gain"] + slope) / wrong**2
    read = math.sqrt(own["read"] ** 2 + max(0.0, variance.mean() - slope * value.mean())) * wrong
    return {"gain": gain, "read": read}, float(variance.mean())


def find_scale(recorder, names, rng):
    """Brings the brightest proper reading near full scale, and saturation to its share of it."""
    levels = [
        np.quantile(p, 0.998) / q["exposure"]
        for p, q in zip(
            recorder.readings([n for n in names if n not in effects.CHAIN_NAMES], None, known_wrong=False),
            recorder.plan["pictures"],
        )
    ]
    recorder.scale = rng.uniform(0.6, 0.9) / max(levels)
    for e in recorder.plan["effects"]:
        if e["name"] == "saturation":
            e["full_scale"] = e["at"] * recorder.scale * max(levels)


def kind_of(plan):
    if not plan["effects"]:
        return "distractor" if plan["distractors"] else "null"
    if len(plan["effects"]) == 2:
        return "pair"
    return "single" if library.RIGHT[plan["effects"][0]["name"]] else "outside"


def plain(entry):
    return {k: v for k, v in entry.items() if k != "factor_of"}


def truth_of(recorder, names, recorded, halves, sigmas, mc_variance, seconds):
    plan = recorder.plan
    on_scene = [n for n in names if n not in effects.CHAIN_NAMES]
    views = recorder.version(on_scene)[1]
    lamps = [
        {
            k: v * recorder.scale * p["exposure"]
            for k, v in recorder.radiance(views, p, None, []).items()
            if k.startswith("lamp")
        }
        for p in plan["pictures"]
    ]
    free = strength.free_directions(plan, lamps, [views[p["camera"]]["surface"] for p in plan["pictures"]], sigmas)
    found, change = [], None
    for e in plan["effects"]:
        rest = [n for n in names if n != e["name"]]
        without = [recorder.readings(rest, half) for half in range(2)]
        measures, left = strength.of_effect(halves, without, sigmas, free)
        change = left if change is None else change + left
        found.append(
            {
                "name": e["name"],
                "right": library.RIGHT[e["name"]],
                "numbers": plain(e),
                **measures,
                "values": library.values(e, [lamp["kind"] for lamp in plan["lamps"]], recorder.scale),
            }
        )
    distractors = None
    if not plan["effects"] and plan["distractors"]:
        without = [
            recorder.readings([], half, errors=plan.get("lamp_errors") is None, known_wrong=False) for half in range(2)
        ]
        distractors, change = strength.of_effect(halves, without, sigmas, free)
    sizes = np.concatenate([(s**2).ravel() for s in sigmas]), np.concatenate([(p**2).ravel() for p in recorded])
    return {
        "seed": plan["seed"],
        "kind": kind_of(plan),
        "effects": found,
        "distractors": [plain(d) for d in plan["distractors"]],
        "distractors_strength": distractors,
        "floor": float(np.sqrt(sizes[0].sum() / sizes[1].sum())),
        "scale": recorder.scale,
        "renderer_share_of_variance": float(np.mean(mc_variance) / np.mean(sizes[0])),
        "surfaces": {
            "ground": plan["ground_albedo"],
            "wall": plan["wall_albedo"],
            **{f"body{i}": o["albedo"] for i, o in enumerate(plan["objects"])},
        },
        "objects": [o["mesh"]["kind"] for o in plan["objects"]],
        "lamps": [l["kind"] for l in plan["lamps"]],
        "lamp_powers": [
            [recorder.scale * l["power"] * c * (2.5 if l["kind"] == "sun" else 1) for c in l["colour"]]
            for l in plan["lamps"]
        ],
        "pictures": [
            {"id": p["id"], "width": plan["cameras"][0]["width"], "height": plan["cameras"][0]["height"]}
            for p in plan["pictures"]
        ],
        "seconds": seconds,
    }, change


def record(seed, cases, truths, bunny):
    begun = time.time()
    plan = draw.draw(seed)
    plan.update(bunny=bunny, material_names=sorted(effects.MATERIAL_NAMES), lamp_errors=None)
    complete(plan)
    name, names = f"{seed:03d}", [e["name"] for e in plan["effects"]]
    folder = os.path.join(cases, name)
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as scratch:
        recorder = Recorder(plan, scratch)
        find_scale(recorder, names, random.Random(f"gonio wild scale {seed}"))
        halves = [recorder.readings(names, half) for half in range(2)]
        mean = recorder.readings(names, None)
        random_ = generator(seed, "noise")
        recorded, noises, sigmas, mc = [], [], [], []
        for picture, a, b, m in zip(plan["pictures"], *halves, mean):
            noisy = camera_chain.with_noise(m, plan["noise"], random_, plan["effects"])
            recorded.append(exr.write_picture(os.path.join(folder, picture["id"] + ".exr"), noisy))
            noise, variance = stated_noise(plan, (a, b), m)
            noises.append(noise)
            sigmas.append(np.sqrt(np.maximum(m, 0) / noise["gain"] + noise["read"] ** 2))
            mc.append(variance)
        shapes = (
            recorder.version([])[0]
            if "dent" in names
            else recorder.version([n for n in names if n not in effects.CHAIN_NAMES])[0]
        )
        for i, shape in enumerate(shapes):
            meshes.write_ply(
                os.path.join(folder, f"body{i}.ply"), shape["points"], shape["triangles"], shape["normals"]
            )
        from mathutils import Euler

        walls = [(place, np.array(Euler(turn).to_matrix())) for place, turn in scene.WALLS[: plan["walls"]]]
        cameras = [scene.camera_pose(c) for c in plan["cameras"]]
        manifest.write(
            os.path.join(folder, "recording.json"), manifest.document(plan, shapes, cameras, walls, noises, folder)
        )
        truth, change = truth_of(recorder, names, recorded, halves, sigmas, mc, time.time() - begun)
    if change is not None:
        np.abs(change).astype("<f4").tofile(os.path.join(truths, name + ".effect"))
    truth["seconds"] = time.time() - begun
    manifest.write(os.path.join(truths, name + ".json"), truth)
    strong = ", ".join(
        f"{e['name']} {100 * e['relative_rms']:.2f} % {e['fair_sigma_rms']:.2f} sigma" for e in truth["effects"]
    )
    print(
        f"wild {name} {truth['seconds']:.1f} s",
        "" if os.environ.get("WILD_QUIET") else f"{truth['kind']} {strong}",
        flush=True,
    )


def main():
    cases, truths, bunny, *seeds = sys.argv[sys.argv.index("--") + 1 :]
    os.makedirs(truths, exist_ok=True)
    for seed in map(int, seeds):
        if not os.path.exists(os.path.join(truths, f"{seed:03d}.json")):
            record(seed, cases, truths, bunny)


main()
