"""U-Net with one encoder after VGG and a decoder for each of four answers (Doest et al. 2021, section 3.3)."""
import torch
from torch import nn
from torch.nn import functional

HEADS = {"mask": 1, "depth": 1, "front": 3, "back": 3}
# With a scale beside each answer but the mask, which is a probability: log of a standard deviation (normals, in units
# of the unit vector) or of a Laplace scale (depth, m).


def block(channels_in, channels_out):
    layers = []
    for first in (channels_in, channels_out):
        layers += [nn.Conv2d(first, channels_out, 3, padding=1, bias=False), nn.BatchNorm2d(channels_out),
                   nn.ReLU(inplace=True)]
    return nn.Sequential(*layers)


class Decoder(nn.Module):
    def __init__(self, widths, channels_out):
        super().__init__()
        self.steps = nn.ModuleList(block(below + here, here) for below, here in zip(widths[:0:-1], widths[-2::-1]))
        self.last = nn.Conv2d(widths[0], channels_out, 1)

    def forward(self, levels):
        here = levels[-1]
        for step, skipped in zip(self.steps, levels[-2::-1]):
            here = functional.interpolate(here, scale_factor=2, mode="bilinear", align_corners=False)
            here = step(torch.cat((here, skipped), dim=1))
        return self.last(here)


class GlassNet(nn.Module):
    """Answers by head: mask as logit, depth in m about `depth_m`, normals as they come; with `scales` one more channel
    of each but the mask. Pictures' sides are multiples of 2^(depth - 1)."""

    def __init__(self, channels_in, heads=tuple(HEADS), width=16, levels=5, scales=False, depth_m=0.55):
        super().__init__()
        self.heads, self.scales, self.levels, self.depth_m = tuple(heads), scales, levels, depth_m
        widths = [min(width << k, 8 * width) for k in range(levels)]
        self.encoder = nn.ModuleList(block(below, here) for below, here in zip([channels_in] + widths, widths))
        self.decoders = nn.ModuleDict(
            {head: Decoder(widths, HEADS[head] + (1 if scales and head != "mask" else 0)) for head in self.heads})

    def forward(self, seen):
        levels = []
        for k, step in enumerate(self.encoder):
            seen = step(seen if k == 0 else functional.max_pool2d(seen, 2))
            levels.append(seen)
        answers = {head: decoder(levels) for head, decoder in self.decoders.items()}
        if "depth" in answers:
            depth = answers["depth"]
            metres = depth[:, :1] * 0.1 + self.depth_m
            answers["depth"] = torch.cat((metres, depth[:, 1:]), dim=1) if self.scales else metres
        return answers


def rooted(seen):
    """About a root, which tames lamps and reflections; straight at zero, signs stay."""
    return seen / torch.sqrt(torch.abs(seen) + 0.01)


class ForExport(nn.Module):
    """What ONNX files of glass-net hold: from pictures in units of their mean light (glass_set.in_mean_light) to the
    answers as one tensor, channels in the order of the heads, the mask as a probability."""

    def __init__(self, net):
        super().__init__()
        self.net = net

    def forward(self, seen):
        answers = self.net(rooted(seen))
        return torch.cat([torch.sigmoid(answers[h]) if h == "mask" else answers[h] for h in self.net.heads], dim=1)


def loss_of_paper(answers, truth):
    """Equation 6: L1 of mask and depth, L2 of both normals, over all pixels; outside of the glass they are zero."""
    total = 0
    for head, answer in answers.items():
        if head == "mask":
            total = total + functional.l1_loss(torch.sigmoid(answer), truth["mask"])
        elif head == "depth":
            total = total + functional.l1_loss(answer[:, :1] * truth["mask"], truth["depth"])
        else:
            total = total + functional.mse_loss(answer[:, :3], truth[head])
    return total


def loss_of_scales(answers, truth):
    """Negative log likelihoods: Bernoulli (mask), Laplace (depth), isotropic normal (normals); within the glass."""
    mask = truth["mask"]
    inside = mask.sum().clamp_min(1)
    total = functional.binary_cross_entropy_with_logits(answers["mask"], mask)
    for head, answer in answers.items():
        if head == "mask":
            continue
        log_scale = answer[:, -1:].clamp(-6, 3)
        if head == "depth":
            each = torch.abs(answer[:, :1] - truth["depth"]) * torch.exp(-log_scale) + log_scale
        else:
            squared = ((answer[:, :3] - truth[head]) ** 2).sum(1, keepdim=True)
            each = squared * torch.exp(-2 * log_scale) / 2 + 3 * log_scale
        total = total + (each * mask).sum() / inside
    return total
