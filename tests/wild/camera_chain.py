"""From radiance to what a camera writes: lens, light scattered in it, shutter, sensor, noise. numpy alone; its own lens
resamples a wider and finer rendering, so that silhouettes and shadows move as a lens moves them.

Pictures are height x width x 3, linear. Pixel centres lie at integers.
"""
import math

import numpy as np

MARGIN_PX = 10  # that a rendering for a lens is wider on every side
FINE = 3  # pixels of that rendering along one of ours


def undistorted(x, y, k1, k2, p1, p2):
    """Inverse of the lens of Brown (1971) in units of the focal length, by fixed-point iteration."""
    u, v = x.copy(), y.copy()
    for _ in range(30):
        r2 = u * u + v * v
        radial = 1 + k1 * r2 + k2 * r2 * r2
        u = (x - 2 * p1 * u * v - p2 * (r2 + 2 * u * u)) / radial
        v = (y - p1 * (r2 + 2 * v * v) - 2 * p2 * u * v) / radial
    return u, v


def ideal_place(x, y, camera, lenses, channel):
    """Where a pinhole camera sees what the true one records at (x, y), px."""
    cx, cy, f = (camera["width"] - 1) / 2, (camera["height"] - 1) / 2, camera["focal_px"]
    for e in lenses:
        name = e["name"]
        if name == "principal_point":
            x, y = x - e["x_px"], y - e["y_px"]
        elif name == "focal_length":
            x, y = cx + (x - cx) / (1 + e["growth"]), cy + (y - cy) / (1 + e["growth"])
        elif name == "pixel_aspect":
            y = cy + (y - cy) / (1 + e["growth_y"])
        elif name == "rolling_shutter":
            x = x - e["px"] * ((y + 0.5) / camera["height"] - 0.5)
        elif name == "lateral_colour" and channel != 1:
            s = 1 + (e["red"] if channel == 0 else e["blue"])
            x, y = cx + (x - cx) / s, cy + (y - cy) / s
        elif name in ("lens_radial", "lens_tangential"):
            u, v = undistorted(
                (x - cx) / f, (y - cy) / f, e.get("k1", 0), e.get("k2", 0), e.get("p1", 0), e.get("p2", 0)
            )
            x, y = cx + f * u, cy + f * v
    return x, y


def integral(fine):
    """Sum of all pixels above and to the left of every corner of a pixel: one more row and column than the picture."""
    out = np.zeros((fine.shape[0] + 1, fine.shape[1] + 1))
    out[1:, 1:] = fine.cumsum(0).cumsum(1)
    return out


def at_corner(sums, x, y):
    """An integral picture between corners: what lies in part of a pixel counts by its area."""
    x, y = np.clip(x, 0, sums.shape[1] - 1.001), np.clip(y, 0, sums.shape[0] - 1.001)
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = x - i, y - j
    above = (1 - s) * sums[j, i] + s * sums[j, i + 1]
    below = (1 - s) * sums[j + 1, i] + s * sums[j + 1, i + 1]
    return (1 - t) * above + t * below


def through_lens(fine, camera, lenses):
    """Picture of the camera's size from a rendering FINE times as fine with MARGIN_PX around it. Each pixel is the mean
    over the upright box between where the middles of its sides look: no displacement is rounded to a finer pixel."""
    height, width = camera["height"], camera["width"]
    x, y = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    out = np.empty((height, width, 3))
    for c in range(3):
        place = lambda dx, dy: ideal_place(x + dx, y + dy, camera, lenses, c)
        left, right = (place(dx, 0)[0] for dx in (-0.5, 0.5))
        top, bottom = (place(0, dy)[1] for dy in (-0.5, 0.5))
        left, right, top, bottom = ((side + 0.5 + MARGIN_PX) * FINE for side in (left, right, top, bottom))
        sums = integral(fine[:, :, c])
        inside = (
            at_corner(sums, right, bottom)
            - at_corner(sums, left, bottom)
            - at_corner(sums, right, top)
            + at_corner(sums, left, top)
        )
        out[:, :, c] = inside / ((right - left) * (bottom - top))
    return out


def blurred(picture, radius_px):
    """Convolved with 1 / (1 + (r / radius)^2)^1.5, cut at the picture's size, of unit sum."""
    height, width, _ = picture.shape
    y, x = np.meshgrid(
        np.fft.fftfreq(2 * height, 1 / (2 * height)), np.fft.fftfreq(2 * width, 1 / (2 * width)), indexing="ij"
    )
    kernel = (1 + (x * x + y * y) / radius_px**2) ** -1.5
    transfer = np.fft.rfft2(kernel / kernel.sum())[:, :, None]
    wide = np.zeros((2 * height, 2 * width, 3))
    wide[:height, :width] = picture
    return np.fft.irfft2(np.fft.rfft2(wide, axes=(0, 1)) * transfer, s=wide.shape[:2], axes=(0, 1))[:height, :width]


def vignette(picture, effect):
    height, width, _ = picture.shape
    y, x = np.mgrid[:height, :width]
    r2 = ((x - (width - 1) / 2) ** 2 + (y - (height - 1) / 2) ** 2) / (width / 2) ** 2
    if effect["law"] == "square":
        factor = 1 - effect["falloff"] * r2
    else:  # cosine to the fourth, of the lens whose falloff this is at half the width
        factor = (1 + (1 / math.sqrt(1 - effect["falloff"]) - 1) * r2) ** -2
    return picture * np.maximum(factor, 0)[:, :, None]


def srgb(v):
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)


def toned(v, effect):
    """A tone curve that leaves 0 and 1."""
    name, v = effect["name"], np.maximum(v, 0)
    if name == "tone_power":
        return v ** effect["gamma"]
    if name == "tone_srgb":
        return (1 - effect["share"]) * v + effect["share"] * srgb(v)
    bent = v * v * (1 + 0.5) / (v * v + 0.5 * np.maximum(v, 1e-9) ** 0.5)  # toe and shoulder
    return (1 - effect["contrast"]) * v + effect["contrast"] * bent


def as_recorded(radiance, camera, picture, plan, found):
    """Noise-free reading. `radiance`: as rendered, brought to readings by the caller, lens already applied. `found`:
    effects of the chain, with what record.py added to them for all pictures alike."""
    v = radiance
    for e in found:
        name = e["name"]
        if name == "bloom":
            v = (1 - e["share"]) * v + e["share"] * blurred(v, e["radius_px"])
        elif name == "veiling_glare":
            v = (1 - e["share"]) * v + e["share"] * v.mean((0, 1))
        elif name == "vignetting":
            v = vignette(v, e)
    for e in found:
        name = e["name"]
        if name == "drift":
            v = v * (1 + e["amplitude"] * math.exp(-picture["time_s"] / e["time_constant_s"]))
        elif name == "flicker_rows":
            rows = np.arange(v.shape[0])[:, None, None]
            v = v * (1 + e["amplitude"] * np.sin(2 * math.pi * rows / e["period_px"] + e["phases"][picture["number"]]))
        elif name == "exposure_error" and picture["number"] in e["pictures"]:
            v = v * (1 + e["relative"])
        elif name in ("fixed_pattern", "dust", "gains"):
            v = v * e["factor_of"](picture)
    for e in found:
        if e["name"] == "crosstalk":
            v = (1 - 3 * e["share"]) * v + e["share"] * v.sum(2, keepdims=True)
    for e in found:
        if e["name"].startswith("tone_"):
            v = toned(v, e)
        elif e["name"] == "black_offset":
            v = v + e["offset"]
    for e in found:
        if e["name"] == "saturation":
            v = np.minimum(v, e["full_scale"])
    return v


def with_noise(v, noise, random, found):
    sigma = np.sqrt(np.maximum(v, 0) / noise["gain"] + noise["read"] ** 2)
    noisy = v + sigma * random.standard_normal(v.shape)
    for e in found:
        if e["name"] == "saturation":
            noisy = np.minimum(noisy, e["full_scale"])
    return noisy
