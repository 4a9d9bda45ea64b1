# See align-peers: trackers of edges, whose one picture is the mask: OpenCV's rapid module, and ViSP's program.
import os
import subprocess
import tempfile
import time

import cv2
import numpy as np

from align_peers_scene import Rim

# They see whole pixels, so theirs are finer than the mask's; hues differ, as two of them compare hues.
FINER, LINES = 3, 400
# Half the length of the search lines, pixels, and how many calls: from coarse to fine.
RAPID = [(20, 40), (8, 20), (4, 20)]


def opencv(scene, create, rounds=None):
    """With the first view, as these trackers have one camera."""
    begun = time.perf_counter()
    tracker = create(np.float32(scene.points), np.int32(scene.triangles))
    lens, camera = scene.lenses[0], scene.cameras[0]
    matrix = np.array([[lens[0] * FINER, 0, (lens[2] + 0.5) * FINER - 0.5],
                       [0, lens[1] * FINER, (lens[3] + 0.5) * FINER - 0.5], [0, 0, 1]])
    pose = camera @ scene.start
    turn, shift = cv2.Rodrigues(pose[:3, :3])[0], pose[:3, 3:].copy()
    size = (scene.masks[0].shape[1] * FINER, scene.masks[0].shape[0] * FINER)
    share = cv2.resize(cv2.GaussianBlur(np.float32(scene.masks[0]), (0, 0), 1), size, interpolation=cv2.INTER_LINEAR)
    picture = np.uint8(np.round(share[..., None] * [0, 128, 255] + (1 - share[..., None]) * [255, 64, 0]))
    once = (cv2.TERM_CRITERIA_MAX_ITER, 1, 0.0)
    try:
        for reach, calls in rounds or RAPID:
            for _ in range(calls):
                _, turn, shift = tracker.compute(picture, LINES, reach * FINER, matrix, turn, shift, once)
    except cv2.error:
        pass  # too few search lines: it has lost the object, and stays where it was
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = cv2.Rodrigues(turn)[0], shift.ravel()
    if not np.isfinite(found).all():
        found = pose
    return np.linalg.inv(camera) @ found, time.perf_counter() - begun


def write_rim_cao(path, scene, view, pose):
    """Edges that lie on the rim of the mesh as it would be seen."""
    height, width = scene.masks[view].shape
    rim = Rim(scene, scene.projected(view, pose), width, height, 2)
    seen = np.bincount(rim.edge, np.abs(rim.outwards), len(rim.ends)) / np.bincount(rim.edge, minlength=len(rim.ends))
    ends = rim.ends[seen > 0.5]
    points = scene.points[ends].reshape(-1, 3)
    with open(path, "w") as file:
        file.write(f"V1\n{len(points)}\n" + "".join("%.9g %.9g %.9g\n" % tuple(p) for p in points))
        file.write(f"{len(ends)}\n" + "".join("%d %d\n" % (2 * k, 2 * k + 1) for k in range(len(ends))))
        file.write("0\n0\n0\n0\n")


def asked(program, scene, views, pose, models, reach, step):
    """A pose and seconds; no pose where the tracker gave up."""
    lines = ""
    for v in range(views):
        numbers = np.concatenate([scene.lenses[v], (scene.cameras[v] @ pose)[:3].ravel()])
        mask = os.path.join(scene.folder, scene.json["views"][v]["mask"])
        lines += " ".join([mask, models[v]] + ["%.12g" % n for n in numbers]) + "\n"
    ended = subprocess.run([program, str(reach), str(step)], input=lines, stdout=subprocess.PIPE,
                           stderr=subprocess.DEVNULL, text=True)
    words = ended.stdout.strip().splitlines()[-1:] or ["lost"]
    if words[0].startswith("lost"):
        return None, 0.0
    numbers = np.array([float(word) for word in words[0].split()])
    if not np.isfinite(numbers).all():
        return None, numbers[12]
    found = np.vstack([numbers[:12].reshape(3, 4), [0, 0, 0, 1]])
    left, _, right = np.linalg.svd(found[:3, :3])  # its inverses let errors of rounding grow from call to call
    found[:3, :3] = left @ right
    return np.linalg.inv(scene.cameras[0]) @ found, numbers[12]


# Search ranges, pixels: one for each model.
VISP = [30] * 4 + [20] * 4 + [10] * 4 + [5] * 6


def visp(program, scene, views, reaches=None, step=2):
    """With a model of the rim alone, made anew before every call. Given the whole mesh the tracker follows the edges of
    all facets, of which a mask shows none, and leaves even the truth. Starting programs does not count."""
    begun, pose, beside = time.perf_counter(), scene.start, 0.0
    with tempfile.TemporaryDirectory() as folder:
        models = [os.path.join(folder, f"{v}.cao") for v in range(views)]
        for reach in reaches or VISP:
            for v in range(views):
                write_rim_cao(models[v], scene, v, pose)
            before = time.perf_counter()
            moved, seconds = asked(program, scene, views, pose, models, reach, step)
            beside += time.perf_counter() - before - seconds
            if moved is None:
                break
            pose = moved
    return pose, time.perf_counter() - begun - beside
