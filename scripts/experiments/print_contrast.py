"""Manifests and the table of print-contrast.mk:

  begin FOLDER                     the printer as it is believed to be and as it is, and a plate
  structure DESIGN                 what dlp-slice --structure is told, from the manifest of dlp-slice --wish
  session PRINTED SENT INCIDENCE   the print before a camera, as it lies and turned by a quarter
  next WISH WISH1 MEASURED         the next wish: the last one and what was missing
  table WISH WISH1 WISH2 MEASURED1 MEASURED2
"""
import json
import math
import os
import sys

CELL_M = 4e-4
PRINTER = {"pixel_m": [1.508e-5, 1.508e-5], "width_px": 480, "height_px": 480, "layer_m": 1.8e-5}


def read(path):
    with open(path) as file:
        return json.load(file)


def write(path, value):
    with open(path, "w") as file:
        json.dump(value, file, indent=1)


def begin(folder):
    believed = dict(PRINTER, growth={"alpha_m": 1.8e-5, "beta_m": 1.024e-5, "gamma": -0.01}, bleed={"sigma_m": 4e-6})
    actual = dict(PRINTER, growth={"alpha_m": 1.86e-5, "beta_m": 0.85e-5, "gamma": -0.02},
                  bleed={"sigma_m": 9e-6, "tail_share": 0.05, "tail_m": 3e-5})
    for name, printer in (("believed", believed), ("actual", actual)):
        write(os.path.join(folder, name + ".json"), {"gonio": 1, "prints": {"plate": printer}})
    x, z = 3.2, 0.09
    with open(os.path.join(folder, "plate.obj"), "w") as file:
        for k in range(8):
            file.write("v %g %g %g\n" % (x if k & 1 else -x, x if k & 2 else -x, z if k & 4 else 0))
        for face in ("1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"):
            file.write("f %s\n" % face)


def structure(design):
    use = read(design)["prints"]["plate"]["microstructures"]["wished"]
    numbers = ",".join("%s=%.9g" % (k, v) for k, v in use.items() if isinstance(v, (int, float)))
    return "%s:%s,file=code,cell_m=%g" % (use["model"], numbers, CELL_M)


def moved(files, folder):
    """Paths of another manifest's files, which begin at its folder, as seen from here."""
    return {k: {"path": os.path.relpath(os.path.join(folder, f["path"]), folder)} for k, f in files.items()}


def session(printed, sent, incidence):
    d, code = read(printed), read(sent)["files"]["code"]
    width = int.from_bytes(open(os.path.join(os.path.dirname(sent), code["path"]), "rb").read(20)[16:20], "big")
    side = width * CELL_M
    top = 0.09e-3
    t = math.radians(float(incidence.removesuffix("deg")))
    px, away = 260, 0.25
    f = px * away / (1.25 * side)
    half = math.sqrt(0.5)
    images, placements, objects = [], [], {}
    scene = {"gonio": 1, "files": moved(d["files"], os.path.dirname(printed)), "meshes": {"m": d["meshes"]["predicted"]},
             "cameras": {"c": {"model": "pinhole", "width_px": px, "height_px": px, "fx_px": f, "fy_px": f,
                               "cx_px": (px - 1) / 2, "cy_px": (px - 1) / 2}},
             "surfaces": {"s": {"model": "conductor", "alpha": 0.1, "eta": 1.5, "k": 0}},
             "objects": [{"id": "plate", "mesh": "m", "surface": "s"}], "lights": {}}
    scene["files"]["code"] = {"path": code["path"]}
    # Turning the plate is turning lamp and camera the other way: the plate stays where the pattern says it is.
    for name, turn in (("before", 0.0), ("after", -math.pi / 2)):
        c, s = math.cos(-turn), math.sin(-turn)
        towards = [math.sin(t) * -s, math.sin(t) * c, math.cos(t)]
        scene["lights"]["lamp-" + name] = {"model": "directional", "towards": towards, "watt_per_m2": 1}
        images.append({"id": name, "camera": "c", "light": "lamp-" + name, "group": name, "response": "linear",
                       "noise": {"gain": 20000, "read": 0.001},
                       "world_from_camera": {"matrix": [[c, s, 0, 0], [s, -c, 0, 0], [0, 0, -1, away], [0, 0, 0, 1]]}})
        placements.append({"name": name, "world_from_pattern": {"rotation": [0, 1, 0, 0], "translation_m": [-side / 2, side / 2, top]}})
    scene["images"] = images
    scene["patterns"] = {"code": {"kind": "data-matrix", "rows": width, "columns": width, "cell_m": [CELL_M], "file": "code",
                                  "placements": placements}}
    return json.dumps(scene, indent=1)


def contrasts(measured):
    """Magnitude of Michelson's contrast, mean of both placements."""
    return [abs(c["michelson"]) for c in read(measured)["contrasts"] if "michelson" in c]


def mean(values):
    return sum(values) / len(values)


def main(words):
    if words[0] == "begin":
        begin(words[1])
    elif words[0] == "structure":
        print(structure(words[1]))
    elif words[0] == "session":
        print(session(*words[1:]))
    elif words[0] == "next":
        wish, last, got = float(words[1]), float(open(words[2]).read()), mean(contrasts(words[3]))
        print("%.4f" % min(0.95, max(0.02, last + wish - got)))
    elif words[0] == "table":
        wish, got = float(words[1]), [mean(contrasts(path)) for path in words[4:6]]
        print("wished %.3f" % wish)
        for k in (0, 1):
            print("print %d: designed for %.3f, measured %.3f, off by %.3f" %
                  (k + 1, float(open(words[2 + k]).read()), got[k], abs(got[k] - wish)))
        nearer = abs(got[1] - wish) < abs(got[0] - wish)
        print("the second print is %s to the wish" % ("nearer" if nearer else "NOT nearer"))
        return 0 if nearer else 1
    return 0


sys.exit(main(sys.argv[1:]))
