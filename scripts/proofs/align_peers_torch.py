# See align-peers: two refinements by differentiable rendering, in PyTorch, of a pose by masks.
#
# soft: Liu et al., Soft Rasterizer (2019), its silhouettes. A triangle covers a pixel for D, the sigmoid of the signed
# square of their distance over sigma squared, and the object covers it for 1 - prod(1 - D). Triangles that face away
# are left out, which changes no silhouette of a closed mesh; so are pixels beyond three sigma of a triangle, as the
# original does. The loss is that of the original, 1 - intersection over union.
# edges: Li et al., Differentiable Monte Carlo ray tracing through edge sampling (2018), of silhouettes. The picture is
# the hard one, four times as fine in both directions; its derivative is the integral along the visible edges.
#
# Both go from coarse to fine: from pictures of a half or a quarter of the size, blurred for the edges, to the whole.
# Adam turns and shifts the object in the first camera's frame about its middle; lengths are in units of its radius.
# Wider sigmas of the soft rasterizer make objects seem larger, as many small triangles cover a pixel outside together:
# of those that were tried (0.15 to 2 pixels) the smallest erred least.
import time

import cv2
import numpy as np
import torch

from align_peers_scene import Rim, area

torch.set_flush_denormal(True)

# Rounds of a refinement: scale of the picture, sigma (pixels of the scaled picture), steps, first and last rate.
SOFT = [(2, 0.3, 40, 0.02, 0.005), (1, 0.15, 40, 0.006, 0.0005)]
EDGES = [(4, 1.5, 50, 0.02, 0.01), (2, 1.0, 50, 0.01, 0.004), (1, 0.7, 50, 0.004, 0.0003)]


def turning(vector):
    """Rotation matrix of a rotation vector, whose derivative exists at zero."""
    x, y, z = vector
    zero = torch.zeros_like(x)
    cross = torch.stack([zero, -z, y, z, zero, -x, -y, x, zero]).reshape(3, 3)
    return torch.matrix_exp(cross)


class Pose:
    """Of a mesh in the world; the numbers that Adam moves are zero where it begins."""

    def __init__(self, scene):
        self.start, self.camera = scene.start, scene.cameras[0]
        middle = self.camera[:3, :3] @ (self.start[:3, :3] @ scene.middle + self.start[:3, 3]) + self.camera[:3, 3]
        self.middle, self.radius = middle, scene.radius
        self.first = torch.tensor(self.camera @ self.start)
        self.about = torch.tensor(middle)
        self.numbers = torch.zeros(6, dtype=torch.float64, requires_grad=True)
        self.points = torch.tensor(scene.points)

    def in_first_camera(self):
        turned = (self.points @ self.first[:3, :3].T + self.first[:3, 3] - self.about) @ turning(self.numbers[:3]).T
        return turned + self.about + self.radius * self.numbers[3:]

    def world_from_object(self):
        with torch.no_grad():
            change = np.eye(4)
            change[:3, :3] = turning(self.numbers[:3]).numpy()
            change[:3, 3] = self.middle + self.radius * self.numbers[3:].numpy() - change[:3, :3] @ self.middle
        return np.linalg.inv(self.camera) @ change @ self.camera @ self.start


def projected(points, change, lens, scale):
    """Pixels of a picture that is `scale` times smaller; the top-left pixel's centre stays (0, 0)."""
    there = points @ torch.tensor(change[:3, :3]).T + torch.tensor(change[:3, 3])
    full = there[:, :2] / there[:, 2:] * torch.tensor(lens[:2]) + torch.tensor(lens[2:])
    return (full + 0.5) / scale - 0.5


def pairs_of(corners, margin, width, height):
    """Numbers of triangles and pixels that are within the margin of the triangles' boxes."""
    low = np.maximum(np.ceil(corners.min(1) - margin), 0).astype(np.int64)
    high = np.minimum(np.floor(corners.max(1) + margin), [width - 1, height - 1]).astype(np.int64)
    size = np.maximum(high - low + 1, 0)
    count = size[:, 0] * size[:, 1]
    triangle = np.repeat(np.arange(len(corners)), count)
    within = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    wide = size[triangle, 0]
    x, y = low[triangle, 0] + within % np.maximum(wide, 1), low[triangle, 1] + within // np.maximum(wide, 1)
    return torch.tensor(triangle), torch.tensor(x), torch.tensor(y)


def soft_silhouette(pixels, triangles, sigma, width, height):
    with torch.no_grad():
        front = area(*(pixels[triangles[:, k]] for k in range(3))) < 0  # y downwards: counter-clockwise from outside
        facing = triangles[front]
        triangle, x, y = pairs_of(pixels[facing].numpy(), 3 * sigma, width, height)
        place = torch.stack([x, y], 1).to(torch.float32)
    corners = pixels[facing].to(torch.float32)
    square, inside = None, None
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        side, off = (b - a)[triangle], place - a[triangle]
        share = ((off * side).sum(1) / (side * side).sum(1).clamp_min(1e-9)).clamp(0, 1)
        gap = ((off - share[:, None] * side) ** 2).sum(1)
        on_it = side[:, 0] * off[:, 1] - side[:, 1] * off[:, 0] <= 0
        square = gap if square is None else torch.minimum(square, gap)
        inside = on_it if inside is None else inside & on_it
    signed = torch.where(inside, square, -square) / sigma ** 2
    uncovered = torch.zeros(width * height).index_add(0, y * width + x, torch.nn.functional.logsigmoid(-signed))
    return (1 - torch.exp(uncovered)).reshape(height, width)


def soft_loss(pixels, scene, target, sigma):
    shown = soft_silhouette(pixels, torch.tensor(scene.triangles), sigma, target.shape[1], target.shape[0])
    wanted = torch.tensor(target)
    return 1 - (shown * wanted).sum() / (shown + wanted - shown * wanted).sum()


def edges_loss(pixels, scene, target, sigma):
    """A number without meaning, whose derivative is that of half the sum of squared differences of blurred pictures."""
    height, width = target.shape
    rim = Rim(scene, pixels.detach().numpy(), width, height)
    shown = rim.share_covered()
    blurred = cv2.GaussianBlur(cv2.GaussianBlur(shown - target, (0, 0), sigma), (0, 0), sigma)
    x, y = np.float32(rim.place).T
    slope = cv2.remap(blurred, x, y, cv2.INTER_LINEAR)[:, 0]
    weight = torch.tensor((slope * rim.outwards * rim.length)[:, None] * rim.normal)
    share, ends = torch.tensor(rim.share)[:, None], torch.tensor(rim.ends[rim.edge])
    return (weight * (pixels[ends[:, 0]] * (1 - share) + pixels[ends[:, 1]] * share)).sum() / target.sum()


def refine(scene, loss_of, rounds, views):
    """World from object, and seconds."""
    begun = time.perf_counter()
    pose = Pose(scene)
    adam = torch.optim.Adam([pose.numbers], lr=1, betas=(0.8, 0.95))
    from_first = [camera @ np.linalg.inv(scene.cameras[0]) for camera in scene.cameras]
    for scale, sigma, steps, rate, last in rounds:
        targets = [np.float32(m.reshape(m.shape[0] // scale, scale, -1, scale).mean((1, 3))) for m in scene.masks]
        for step in range(steps):
            adam.param_groups[0]["lr"] = rate * (last / rate) ** (step / max(1, steps - 1))
            adam.zero_grad()
            points = pose.in_first_camera()
            pictures = [projected(points, from_first[v], scene.lenses[v], scale) for v in range(views)]
            loss = sum(loss_of(pictures[v], scene, targets[v], sigma) for v in range(views))
            loss.backward()
            if not torch.isfinite(pose.numbers.grad).all():
                return scene.start, time.perf_counter() - begun
            adam.step()
    return pose.world_from_object(), time.perf_counter() - begun


def soft(scene, views, rounds=None):
    return refine(scene, soft_loss, rounds or SOFT, views)


def edges(scene, views, rounds=None):
    return refine(scene, edges_loss, rounds or EDGES, views)
