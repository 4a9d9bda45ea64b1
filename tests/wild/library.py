"""Which of the library's names count as right for an effect (right.json: alternatives, the first stands for all; none:
outside the library), and which of the library's numbers mean what ours do. Pure Python.

python3 library.py TRUTHS brings the truths of a folder up to date: names and numbers may be entered here after a case
was recorded, what was drawn and recorded does not depend on them.
"""

import glob
import json
import math
import os
import sys

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "right.json"), encoding="utf-8") as file:
    RIGHT = json.load(file)


def values(effect, lamps, scale):
    """[{mechanism, parameter, value, exact, is_size}]: numbers of the library that mean what ours do. `lamps`: their
    kinds; `scale`: readings over radiance."""
    e = effect
    name = e["name"]

    def of(mechanism, exact=True, **numbers):
        return [
            {"mechanism": mechanism, "parameter": k, "value": v, "exact": exact, "is_size": True}
            for k, v in numbers.items()
        ]

    if name == "lens_radial":
        return of("lens.radial", k1=e["k1"], **({"k2": e["k2"]} if e["k2"] else {}))
    if name == "lens_tangential":
        return of("lens.tangential", p1=e["p1"], p2=e["p2"])
    if name == "focal_length":
        return of("camera.focal-length", relative=e["growth"])
    if name == "pixel_aspect":
        return of("camera.aspect", relative=e["growth_y"])
    if name == "principal_point":
        return of("camera.principal-point", x_px=e["x_px"], y_px=e["y_px"])
    if name == "bloom":  # its kernel has a sum of one over twice the picture, the library's over the plane
        return of("optics.bloom", exact=False, share=e["share"], radius_px=e["radius_px"])
    if name == "saturation" and "full_scale" in e:
        return of("sensor.saturation", full_scale=e["full_scale"])
    if name == "ambient" and not e["from_above"]:
        radiance = [scale * 2.5 / math.pi * e["share"] * c for c in e["colour"]]
        return of("light.ambient", **{f"radiance_{c}": v for c, v in zip("rgb", radiance)})
    if name == "metal":
        return of("surface.metal", exact=False, metal=e["share"])
    if name == "translucent_sheet":
        return of("surface.translucent", translucent=e["share"])
    if name == "vignetting" and e["law"] == "square":
        return of("optics.vignetting", falloff=e["falloff"])
    if name == "black_offset":
        return of("sensor.black-offset", offset=e["offset"])
    if name == "tone_power":
        return of("sensor.non-linearity", gamma=e["gamma"])
    if name == "veiling_glare":
        return of("optics.veiling-glare", share=e["share"] / (1 - e["share"]))
    if name == "crosstalk":
        return of("sensor.crosstalk", share=e["share"])
    if name == "fixed_pattern":
        return of("sensor.prnu", sigma=e["sigma"])
    if name == "flicker_rows":
        return of("sensor.row-pattern", amplitude=e["amplitude"])
    if name == "drift":
        return of("light.drift", amplitude=e["amplitude"])
    if name == "finite_size" and all(kind == "point" for kind in lamps):
        return of("light.finite-size", radius_m=e["radius_m"])
    if name == "lobe":
        return of("light.lobe", exponent=e["exponent"])
    if name in ("clear_coat", "coat_part", "roughness_varying"):
        f0 = ((e["index"] - 1) / (e["index"] + 1)) ** 2
        alone = {"alpha": e["roughness"] ** 2} if name == "clear_coat" else {}
        return of("surface.interface", exact=False, f0=f0, **alone)
    if name == "scale":
        return of("geometry.scale", growth=e["growth"])
    if name == "fog":  # its light is scattered any number of times
        return of("volume.fog", exact=False, sigma_t_per_m=e["per_m"])
    if name == "stain":
        return of("surface.spatial-variation", depth=-e["depth"])
    return []


def main(folder):
    for path in sorted(glob.glob(os.path.join(folder, "*.json"))):
        with open(path, encoding="utf-8") as file:
            truth = json.load(file)
        before = json.dumps(truth)
        for e in truth["effects"]:
            e["right"] = RIGHT[e["name"]]
            e["values"] = values(e["numbers"], truth["lamps"], truth["scale"])
        if json.dumps(truth) != before:
            with open(path + ".part", "w", encoding="utf-8") as file:
                json.dump(truth, file, indent=1)
                file.write("\n")
            os.replace(path + ".part", path)


if __name__ == "__main__":
    main(sys.argv[1])
