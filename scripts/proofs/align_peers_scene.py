# See align-peers: a scene that export-align-scenes wrote, and how far a pose is from its truth.
import json
import math
import os

import cv2
import numpy as np


def matrix_of(pose):
    w, x, y, z = np.array(pose["rotation_wxyz"]) / np.linalg.norm(pose["rotation_wxyz"])
    m = np.eye(4)
    m[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                 [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                 [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    m[:3, 3] = pose["translation_m"]
    return m


def read_ply(path):
    """Of the one kind that the exporter writes: binary, double coordinates, triangles."""
    with open(path, "rb") as file:
        data = file.read()
    head, body = data[:data.index(b"end_header\n")].decode(), data[data.index(b"end_header\n") + 11:]
    count = {line.split()[1]: int(line.split()[2]) for line in head.splitlines() if line.startswith("element")}
    points = np.frombuffer(body, "<f8", 3 * count["vertex"]).reshape(-1, 3)
    faces = np.frombuffer(body, np.dtype([("n", "u1"), ("v", "<u4", 3)]), count["face"], 24 * count["vertex"])
    return points, faces["v"].astype(np.int64)


class Scene:
    def __init__(self, folder):
        self.folder = folder
        with open(os.path.join(folder, "scene.json")) as file:
            self.json = json.load(file)
        self.points, triangles = read_ply(os.path.join(folder, "mesh.ply"))
        sides = [self.points[triangles[:, k]] - self.points[triangles[:, 0]] for k in (1, 2)]
        self.triangles = triangles[np.linalg.norm(np.cross(*sides), axis=1) > 1e-14]
        self.middle = np.array(self.json["middle_of_mesh_m"])
        self.radius = np.linalg.norm(self.points - self.middle, axis=1).max()
        self.views = len(self.json["views"])
        self.cameras = [matrix_of(view["camera_from_world"]) for view in self.json["views"]]
        self.lenses = [np.array(view["fx_fy_cx_cy_px"]) for view in self.json["views"]]
        self.masks = [cv2.imread(os.path.join(folder, view["mask"]), cv2.IMREAD_GRAYSCALE) / 255.0
                      for view in self.json["views"]]
        self.true = matrix_of(self.json["true_world_from_object"])
        self.start = matrix_of(self.json["start_world_from_object"])
        self.find_edges()

    def find_edges(self):
        """Edges, by their places, and the two triangles of each; the world's meshes are closed up to poles."""
        _, same = np.unique(np.round(self.points, 9), axis=0, return_inverse=True)
        known = {}
        for t, corners in enumerate(self.triangles):
            for k in range(3):
                a, b = corners[k], corners[(k + 1) % 3]
                known.setdefault(tuple(sorted((same[a], same[b]))), []).append((t, a, b))
        pairs = [uses for uses in known.values() if len(uses) == 2]
        self.edges = np.array([uses[0][1:] for uses in pairs])
        self.edge_sides = np.array([[use[0] for use in uses] for uses in pairs])

    def errors(self, found):
        """Degrees and millimetres, of the mesh's middle, after the turn that looks alike and is nearest."""
        turns = [matrix_of({"rotation_wxyz": q, "translation_m": [0, 0, 0]})[:3, :3] for q in
                 self.json["same_turned_by_wxyz"]]
        apart = found[:3, :3].T @ self.true[:3, :3]
        if self.json["turns_freely_about_z"]:
            cosine = apart[2, 2]
        else:
            cosine = max((np.trace(apart @ turn) - 1) / 2 for turn in turns)
        shift = (found - self.true)[:3] @ np.append(self.middle, 1)
        return math.degrees(math.acos(min(1, max(-1, cosine)))), 1e3 * np.linalg.norm(shift)

    def projected(self, view, world_from_object):
        there = self.cameras[view] @ world_from_object
        points = self.points @ there[:3, :3].T + there[:3, 3]
        return points[:, :2] / points[:, 2:] * self.lenses[view][:2] + self.lenses[view][2:]


def area(a, b, c):
    """Twice a triangle's, in a picture whose y points downwards: negative where it faces the camera."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])


def filled(corners, width, height, fine):
    """0 or 1 for every place of a grid `fine` times as fine as the picture; half a place too large, as OpenCV's are."""
    bits = 6
    codes = np.round(((corners + 0.5) * fine - 0.5) * (1 << bits)).astype(np.int32)
    picture = np.zeros((height * fine, width * fine), np.uint8)
    for triangle in codes:
        cv2.fillConvexPoly(picture, triangle, 1, cv2.LINE_8, bits)
    return picture


class Rim:
    """Places along edges of a projected mesh that may lie on its silhouette; its picture, `fine` times as fine."""

    def __init__(self, scene, pixels, width, height, fine=4):
        facing = area(*(pixels[scene.triangles[:, k]] for k in range(3))) < 0
        self.size, self.fine = (width, height), fine
        self.picture = filled(pixels[scene.triangles[facing]], width, height, fine)
        self.ends = scene.edges[facing[scene.edge_sides[:, 0]] != facing[scene.edge_sides[:, 1]]]
        along = pixels[self.ends[:, 1]] - pixels[self.ends[:, 0]]
        length = np.linalg.norm(along, axis=1)
        count = np.maximum(1, np.ceil(length)).astype(int)
        self.edge = np.repeat(np.arange(len(count)), count)
        self.share = (np.arange(len(self.edge)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[self.edge]
        self.place = pixels[self.ends[self.edge, 0]] + self.share[:, None] * along[self.edge]
        self.length = (length / count)[self.edge]
        normal = np.stack([along[:, 1], -along[:, 0]], 1) / np.maximum(length[:, None], 1e-9)
        self.normal = normal[self.edge]

        def covered(at):
            cell = np.round((at + 0.5) * fine - 0.5).astype(int).clip(0, [width * fine - 1, height * fine - 1])
            return self.picture[cell[:, 1], cell[:, 0]].astype(int)

        # 1: the normal points outwards; -1: inwards; 0: an edge before the object itself, which is no rim
        self.outwards = covered(self.place - 0.5 * self.normal) - covered(self.place + 0.5 * self.normal)

    def share_covered(self):
        """Of every pixel. A place less on every side is half a place too small: the mean of the two is right."""
        smaller = cv2.erode(self.picture, cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3)))
        (width, height), fine = self.size, self.fine
        return (self.picture + smaller).reshape(height, fine, width, fine).mean((1, 3), dtype=np.float32) / 2
