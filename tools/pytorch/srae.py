"""SRAE (Shan et al., "Simulation-based lidar super-resolution for ground vehicles", 2020) as a PyTorch
module.

Weights of the authors' Keras model: kernels go from rows x columns x in x out (Conv2DTranspose: rows x
columns x out x in) to PyTorch's layouts, and are turned by 180 degrees ([..., ::-1, ::-1]), because
their images have the lowest beam first and columns counter-clockwise.
"""

import math

import torch
from torch import nn
from torch.nn import functional

from layers import FromWeights, Rows

EPSILON = 1e-3
MOMENTUM = 0.01


class Norm(nn.Module):
    def __init__(self, channels):
        super().__init__()
        self.weight, self.bias = nn.Parameter(torch.ones(channels)), nn.Parameter(torch.zeros(channels))
        self.register_buffer("running_mean", torch.zeros(channels))
        self.register_buffer("running_var", torch.ones(channels))

    def forward(self, x):
        return functional.batch_norm(x, self.running_mean, self.running_var, self.weight, self.bias,
                                     self.training, MOMENTUM, EPSILON)


class Unit(nn.Module):
    """Convolution, batch norm, ReLU."""

    def __init__(self, convolution):
        super().__init__()
        self.convolution, self.norm = convolution, Norm(convolution.out_channels)

    def forward(self, x):
        return torch.relu(self.norm(self.convolution(x)))


def conv(inputs, outputs):
    return Unit(nn.Conv2d(inputs, outputs, 3, padding=1))


def up(inputs, outputs, stride):
    more = tuple(s - 1 for s in stride)
    return Unit(nn.ConvTranspose2d(inputs, outputs, 3, stride, padding=1, output_padding=more))


class Up(nn.Sequential):
    """Two convolutions on what comes from below and from the side; `up` is what comes from below."""

    def __init__(self, inputs, outputs):
        super().__init__(conv(2 * outputs, outputs), conv(outputs, outputs))
        self.up = up(inputs, outputs, (2, 2))

    def forward(self, below, side):
        x = torch.cat([self.up(below), side], 1)
        return self[1](self[0](x))


class Srae(FromWeights):
    def __init__(self, network):
        super().__init__()
        self.scale_m, self.rows = network["range_scale_m"], Rows(network)
        self.share, self.passes = network["dropout"], network["passes"]
        self.largest_deviation = network["largest_deviation"]
        c = [network["filters"] * 2**i for i in range(5)]
        ups = round(math.log2(self.rows.stride))
        self.up = nn.Sequential(*[up(1 if i == 0 else c[0], c[0], (2, 1)) for i in range(ups)])
        self.encoder = nn.ModuleList([nn.Sequential(conv(a, b), conv(b, b))
                                      for a, b in zip([c[0]] + c, c)])
        self.decoder = nn.ModuleList([Up(c[i + 1], c[i]) for i in (3, 2, 1, 0)])
        self.head = nn.Conv2d(c[0], 1, 1)
        self.double()

    def dropout(self, x, place):
        """place: which of the eight; x as it is where only one pass is made."""
        return functional.dropout(x, self.share, self.training or self.passes > 1)

    def image(self, measured_m):
        """One pass. measured_m: scans x rows x columns; the result in units of range_scale_m."""
        x = self.encoder[0](self.up(measured_m[:, None] / self.scale_m))
        sides = [x]
        for i in range(1, 5):
            x = self.encoder[i](self.dropout(functional.avg_pool2d(x, 2), i - 1))
            sides.append(x)
        for i in range(4):
            x = self.decoder[i](self.dropout(x, 4 + i), sides[3 - i])
        return torch.relu(self.head(x))[:, 0]

    def loss(self, measured_m, truth_m):
        """Of each scan: the mean over all pixels, no return counting as 0."""
        return (self.image(measured_m) - truth_m / self.scale_m).abs().mean((1, 2))

    def self_test(self, measured_m):
        """One pass without dropout, metres."""
        passes, self.passes = self.passes, 1
        image = self.image(measured_m[None])[0] * self.scale_m
        self.passes = passes
        return image

    def forward(self, measured_m):
        """measured_m: measured rows x columns, metres, 0 = no return. All rows: range_m, 0 where the
        passes do not agree; measured rows as they were."""
        images = torch.stack([self.image(measured_m[None])[0] for _ in range(self.passes)])
        range_m = images.mean(0)
        if self.passes > 1:
            deviation = images.std(0, correction=0)
            range_m[deviation > self.largest_deviation * range_m] = 0.0
        range_m = range_m * self.scale_m
        range_m[self.rows.measured] = measured_m
        return {"range_m": range_m}
