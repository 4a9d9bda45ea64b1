"""recording.json: what a fair user would have measured and written. Pure Python."""
import hashlib
import json
import os


def file_entry(folder, name):
    with open(os.path.join(folder, name), "rb") as file:
        data = file.read()
    return {"path": name, "bytes": len(data), "sha256": hashlib.sha256(data).hexdigest()}


def free(value, **more):
    return {"value": value, "free": True, **more}


def albedo(known=None):
    return known if known else free([0.5, 0.5, 0.5], min=0, max=1)


def pose(rotation, place):
    return {"matrix": [[*map(float, row), float(p)] for row, p in zip(rotation, place)] + [[0, 0, 0, 1]]}


def light_entry(plan, lamp):
    shared = {"share": "intensity"} if plan["lamps_equal"] else {}
    start = free([1.0, 1.0, 1.0], **shared)
    if lamp["kind"] == "sun":
        return {"model": "directional", "towards": lamp["towards"], "watt_per_m2": start}
    entry = {"model": "point", "position_m": lamp["position_m"], "watt_per_sr": start}
    if lamp["kind"] == "sphere":
        entry = {
            "model": "sphere",
            "position_m": lamp["position_m"],
            "radius_m": lamp["radius_m"],
            "watt_per_sr": start,
        }
    return entry


def document(plan, shapes, cameras, walls, noises, folder):
    """`cameras`: (rotation, place) of each; `walls`: (place, rotation) of those there are; `noises`: of pictures."""
    camera = plan["cameras"][0]
    gains = next((d for d in plan["distractors"] if d["name"] == "gains"), None)
    whole = {"gonio": 1, "files": {}}
    whole["cameras"] = {
        "camera": {
            "model": "pinhole",
            "width_px": camera["width"],
            "height_px": camera["height"],
            "fx_px": camera["focal_px"],
            "fy_px": camera["focal_px"],
            "cx_px": (camera["width"] - 1) / 2,
            "cy_px": (camera["height"] - 1) / 2,
        }
    }
    whole["meshes"] = {"ground": {"plane": {"size_m": [1.2, 1.2]}}}
    whole["surfaces"] = {
        "ground": {"model": "diffuse", "albedo": albedo(plan["ground_known"] and plan["ground_albedo"])}
    }
    whole["lights"] = {f"lamp{i}": light_entry(plan, lamp) for i, lamp in enumerate(plan["lamps"])}
    whole["images"] = []
    whole["objects"] = [{"id": "ground", "mesh": "ground", "surface": "ground"}]
    if walls:
        whole["meshes"]["wall"] = {"plane": {"size_m": [0.6, 0.6]}}
        whole["surfaces"]["wall"] = {"model": "diffuse", "albedo": albedo()}
    for i, (place, rotation) in enumerate(walls):
        whole["objects"].append(
            {"id": f"wall{i}", "mesh": "wall", "surface": "wall", "world_from_object": pose(rotation, place)}
        )
    for i, shape in enumerate(shapes):
        name = f"body{i}"
        whole["files"][name] = file_entry(folder, name + ".ply")
        whole["meshes"][name] = {"file": name, **({} if shape["normals"] is not None else {"normals": "flat"})}
        whole["surfaces"][name] = {"model": "diffuse", "albedo": albedo()}
        whole["objects"].append(
            {
                "id": name,
                "mesh": name,
                "surface": name,
                "world_from_object": {"rotation": shape["turn"], "translation_m": shape["place"]},
            }
        )
    for picture, noise in zip(plan["pictures"], noises):
        name = picture["id"]
        whole["files"][name] = file_entry(folder, name + ".exr")
        entry = {
            "id": name,
            "file": name,
            "camera": "camera",
            "world_from_camera": pose(*cameras[picture["camera"]]),
            "light": [f"lamp{i}" for i in picture["lamps"]],
            "exposure_s": 0.02 * picture["exposure"],
            "time_s": picture["time_s"],
            "response": "linear",
            "noise": noise,
        }
        if gains:
            entry["gain"] = free(
                picture["exposure"],
                min=0.5 * picture["exposure"],
                max=2 * picture["exposure"],
                sigma=gains["sigma"] * picture["exposure"],
            )
        elif picture["exposure"] != 1:
            entry["gain"] = picture["exposure"]
        whole["images"].append(entry)
    return whole


def write(path, document_):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(document_, file, indent=1)
        file.write("\n")
