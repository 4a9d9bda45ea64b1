# SciPy's side of `scripts/bench nrsfm`: the truncated error of Jensen et al. 2018 with its alignment, in NumPy with
# scipy.optimize.least_squares (method lm), as a script of one's own would have it: residuals are the truncated distances,
# so that half their sum of squares is the measure's; the start is Procrustes, once as a rotation and once as a reflection.
#   nrsfm_peer.py FILE FRAMES POINTS COUNT -> seconds a sequence, mean value, residual evaluations a sequence
# FILE: COUNT pairs of doubles, frames x points x 3 of the reconstruction, then of the truth.
import sys, time
import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

path, frames, points, count = sys.argv[1], *map(int, sys.argv[2:5])
data = np.fromfile(path).reshape(-1, 2, frames * points, 3)


def procrustes(x, q, hand):
    u, s, v = np.linalg.svd(q.T @ (hand * x))
    d = np.array([1, 1, np.sign(np.linalg.det(u @ v))])
    return (u * d) @ v, (s * d).sum() / (x * x).sum()


def robust(x, q):
    x, q = x - x.mean(0), q - q.mean(0)
    best, evaluations = np.inf, 0
    for hand in (1, -1):
        r, s = procrustes(x, q, hand)
        start = np.r_[np.log(max(s, 1e-3)), Rotation.from_matrix(r).as_rotvec(), 0, 0, 0]
        y = hand * x

        def residual(p):
            e = np.exp(p[0]) * (y @ Rotation.from_rotvec(p[1:4]).as_matrix().T) + p[4:] - q
            d = np.sqrt((e * e).sum(axis=1))
            e1, e3 = np.percentile(d, [25, 75])
            return np.minimum(d, e3 + 1.5 * (e3 - e1))

        found = least_squares(residual, start, method="lm")
        evaluations += found.nfev
        best = min(best, np.sqrt(2 * found.cost / len(x)))
    return best, evaluations


begun = time.perf_counter()
answers = [robust(*data[k % len(data)]) for k in range(count)]
took = time.perf_counter() - begun
print("%.6f %.9f %.1f" % (took / count, np.mean([a[0] for a in answers]), np.mean([a[1] for a in answers])))
