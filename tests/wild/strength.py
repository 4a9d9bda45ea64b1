"""How strong an effect is in recordings, from renderings with and without it, each as two halves of independent
samples: products of halves have no bias from the renderer's noise. numpy alone.
"""
import numpy as np


def whitened(pictures, sigmas):
    return np.concatenate([(p / s).ravel() for p, s in zip(pictures, sigmas)])


def free_directions(plan, by_lamp, surfaces, sigmas):
    """What the pictures can change by through numbers that the manifest leaves free, to first order: albedo of each
    surface and intensity of the lamps, by channel; orthonormal columns. `by_lamp`: readings of picture and lamp."""
    columns = []

    def enter(pieces):
        for channel in range(3):
            only = np.zeros(3)
            only[channel] = 1
            columns.append(whitened([p * only for p in pieces], sigmas))

    whole = [sum(lamps.values()) for lamps in by_lamp]
    known = {1} if plan["ground_known"] else set()
    for index in sorted({int(i) for s in surfaces for i in np.unique(s)} - {0} - known):
        enter([p * (s == index)[:, :, None] for p, s in zip(whole, surfaces)])
    names = sorted({name for lamps in by_lamp for name in lamps})
    for name in [names] if plan["lamps_equal"] else [[n] for n in names]:
        enter([sum((lamps[n] for n in name if n in lamps), np.zeros_like(p)) for lamps, p in zip(by_lamp, whole)])
    columns = [c for c in columns if np.linalg.norm(c) > 0]
    u, s, _ = np.linalg.svd(np.stack(columns, 1), full_matrices=False)
    return u[:, s > 1e-6 * s[0]]


def root(square):
    """Of a mean that noise may have made negative."""
    return float(np.sqrt(max(square, 0.0)))


def of_effect(with_it, without, sigmas, free):
    """`with_it`, `without`: (first halves, second halves) of all pictures. Root mean squares of the change: of the
    signal, in noise widths; and after the fair refit: of the signal, in noise widths, as a length in noise widths."""
    signal = np.concatenate([p.ravel() for p in without[0]]), np.concatenate([p.ravel() for p in without[1]])
    plain, white = [], []
    for half in range(2):
        change = [a - b for a, b in zip(with_it[half], without[half])]
        plain.append(np.concatenate([c.ravel() for c in change]))
        white.append(whitened(change, sigmas))
    left = [w - free @ (free.T @ w) for w in white]
    scale = np.concatenate([np.broadcast_to(s, p.shape).ravel() for s, p in zip(sigmas, without[0])])
    power = np.mean(signal[0] * signal[1])
    fair = [x * scale for x in left]
    return {
        "relative_rms": root(np.mean(plain[0] * plain[1]) / power),
        "sigma_rms": root(np.mean(white[0] * white[1])),
        "fair_relative_rms": root(np.mean(fair[0] * fair[1]) / power),
        "fair_sigma_rms": root(np.mean(left[0] * left[1])),
        "fair_length": root(np.sum(left[0] * left[1])),
    }, 0.5 * (left[0] + left[1])
