# See align-peers: has every method refine the same poses by the same masks, and prints the table.
# usage: align_peers.py FOLDER [VISP_PROGRAM]: scenes of export-align-scenes
import os
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("align-peers: not run: numpy is missing (apt-get install python3-numpy)")
try:
    import cv2
except ImportError:
    sys.exit("align-peers: not run: OpenCV for Python is missing (apt-get install python3-opencv)")

import align_peers_scene
import align_peers_trackers

folder, visp_program = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
scenes = [align_peers_scene.Scene(os.path.join(folder, str(k))) for k in
          range(sum(name.isdigit() for name in os.listdir(folder)))]


def own(scene, views):
    """What align() found: the exporter asked it, from the start and from the truth."""
    which = ("first_view" if views == 1 else "all_views") + ("_from_truth" if scene.start is scene.true else "")
    answer = scene.json["answers"][which]
    return align_peers_scene.matrix_of(answer), answer["seconds"]


methods = [("the start itself", lambda scene, views: (scene.start, 0.0), (1,)), ("align", own, (4, 1))]
try:
    import align_peers_torch
    methods.append(("soft rasterizer, PyTorch", align_peers_torch.soft, (4, 1)))
    methods.append(("edge sampling, PyTorch", align_peers_torch.edges, (4, 1)))
except ImportError:
    print("align-peers: no differentiable rendering: PyTorch is missing (apt-get install python3-torch)", flush=True)
if hasattr(cv2, "rapid"):
    for name in ("Rapid", "OLSTracker", "GOSTracker"):
        create = getattr(cv2.rapid, name + "_create")
        methods.append((f"OpenCV rapid {name}",
                        lambda scene, views, create=create: align_peers_trackers.opencv(scene, create), (1,)))
else:
    print("align-peers: no OpenCV rapid: this OpenCV was built without its module (Debian's python3-opencv has it)")
if visp_program:
    methods.append(("ViSP moving edges",
                    lambda scene, views: align_peers_trackers.visp(visp_program, scene, views), (4, 1)))


def row(name, method, most):
    errors, seconds, drift = [], [], []
    for k, scene in enumerate(scenes):
        views = min(most, scene.views)
        found, time = method(scene, views)
        errors.append(scene.errors(found)), seconds.append(time)
        if k < 8:  # one of each solid
            start, scene.start = scene.start, scene.true
            drift.append(scene.errors(method(scene, views)[0]))
            scene.start = start
    turn, shift = np.array(errors).T
    share = [100 * np.mean((turn < 1) & (shift < limit)) for limit in (2, 3)]
    shown = "first" if most == 1 else "all"
    print(f"{name:<25} {shown:<5} {len(scenes):>6} {share[0]:>8.1f} % {share[1]:>8.1f} % {np.median(turn):>10.3f} "
          f"{np.median(shift):>10.3f} {np.median(seconds):>9.2f} {np.median([d[0] for d in drift]):>9.3f} "
          f"{np.median([d[1] for d in drift]):>7.3f}", flush=True)
    return share[0]


print("success: within 1 degree and 2 mm (3 mm: what prove-align calls converged), turns that look alike being one;\n"
      "medians of the errors and of the seconds; the last two columns: medians of eight scenes begun at the truth.")
print(f"{'method':<25} {'views':<5} {'scenes':>6} {'2 mm':>10} {'3 mm':>10} {'turn [deg]':>10} {'shift [mm]':>10} "
      f"{'time [s]':>9} {'deg':>9} {'mm':>7}")
for name, method, shown in methods:
    for most in shown:
        row(name, method, most)
