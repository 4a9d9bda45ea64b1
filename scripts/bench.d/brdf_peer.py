# SciPy's side of `scripts/bench brdf`: the surface model coated-diffuse in NumPy, whole columns at a time, what no number
# changes computed once; the same samples, start, scale and tolerance as the program's.
#   brdf_peer.py FOLDER ROWS BANDS -> least seconds of three fits (the faster of methods lm and trf), evaluations, rms,
#   alpha, f0
import sys, time
import numpy as np
from scipy.optimize import least_squares

folder, rows, bands = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
data = np.fromfile(folder + "/samples.bin").reshape(rows, 6 + bands)
energy = np.fromfile(folder + "/energy.bin").reshape(32, 17, 50)
wi, wo, f = data[:, :3], data[:, 3:6], data[:, 6:]
h = wi + wo
length = np.sqrt((h * h).sum(axis=1))
h = h / length[:, None]
c = np.minimum(length / 2, 1)  # of wi and the half vector
ci, co, hz = wi[:, 2], wo[:, 2], h[:, 2]
si2, so2, hz2, sh2, c2 = 1 - ci * ci, 1 - co * co, hz * hz, 1 - hz * hz, c * c
ti, to, nodes = np.sqrt(ci), np.sqrt(co), np.linspace(0, 1, 49)
weight = 100 * ci * co
measured = np.log1p(weight[:, None] * f)

def of_energy(alpha, f0):
    a = np.clip(31 * np.log(alpha / 0.02) / np.log(50), 0, 31)
    b = np.clip(16 * (f0 / 0.2) ** 0.25, 0, 16)
    i, j = min(int(a), 30), min(int(b), 15)
    a, b = a - i, b - j
    e = energy
    return (1 - a) * ((1 - b) * e[i, j] + b * e[i, j + 1]) + a * ((1 - b) * e[i + 1, j] + b * e[i + 1, j + 1])

def residual(x):
    f0, alpha, albedo = np.clip(x[0], 1e-12, 0.2), np.clip(x[1], 0.02, 1), x[2:]  # lm knows no bounds
    eta = (1 + np.sqrt(f0)) / (1 - np.sqrt(f0))
    t = np.sqrt(1 - (1 - c2) / (eta * eta))
    s, p = (c - eta * t) / (c + eta * t), (eta * c - t) / (eta * c + t)
    a2 = alpha * alpha
    q = a2 * hz2 + sh2
    gloss = (s * s + p * p) * a2 / (4 * np.pi * q * q * (co * np.sqrt(ci * ci + a2 * si2) + ci * np.sqrt(co * co + a2 * so2)))
    e = of_energy(alpha, f0)
    base = (1 - np.interp(ti, nodes, e[1:])) * (1 - np.interp(to, nodes, e[1:])) / ((1 - e[0]) * np.pi)
    model = weight[:, None] * (gloss[:, None] + base[:, None] * albedo)
    if model.min() > -0.5:
        return (measured - np.log1p(model)).ravel()
    # As the program does: the tangent of the logarithm where a trial of lm takes the albedo far below zero.
    return (measured - np.where(model > -0.5, np.log1p(np.maximum(model, -0.5)), np.log(0.5) + 2 * (model + 0.5))).ravel()

start = np.array([0.02, 0.4] + [0.5] * bands)
best = None
for method in ("lm", "trf"):
    bounds = (-np.inf, np.inf) if method == "lm" else ([0, 0.02] + [0] * bands, [0.2, 1] + [1] * bands)
    for _ in range(3):
        begun = time.perf_counter()
        try:
            r = least_squares(residual, start, method=method, bounds=bounds, x_scale=np.maximum(start, 0.01), ftol=1e-8)
        except ValueError:
            continue
        took = time.perf_counter() - begun
        if best is None or took < best[0]:
            best = (took, r.nfev, np.sqrt(np.mean(r.fun ** 2)), r.x[1], r.x[0], method)
print("%.6f %d %.8f %.6f %.6f %s" % best)
