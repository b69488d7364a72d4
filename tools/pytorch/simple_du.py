"""Simple DU (nn/hqs/plain_prior.h) as a PyTorch module."""

import torch
from torch import nn
from torch.nn import functional

from layers import FromWeights, Rows


class Plain(nn.Module):
    def __init__(self, denoiser):
        super().__init__()
        c = [1] + [denoiser["features"]] * (denoiser["convolutions"] - 1) + [1]
        self.convolution = nn.ModuleList(
            [nn.Conv2d(a, b, 3, padding=1, bias=False) for a, b in zip(c, c[1:])])
        self.dropout = denoiser["dropout"]

    def forward(self, x):
        for i, layer in enumerate(self.convolution):
            x = layer(x)
            if i + 1 < len(self.convolution):
                x = functional.dropout(torch.relu(x), self.dropout, self.training)
        return x


class SimpleDu(FromWeights):
    def __init__(self, network):
        super().__init__()
        self.scale_m, self.rows, self.count = network["range_scale_m"], Rows(network), network["layers"]
        own = 1 if network["shared_weights"] else self.count
        self.layers = nn.ModuleList([Plain(network["denoiser"]) for _ in range(own)])
        self.alpha = nn.Parameter(torch.ones(1))
        self.double()

    def iterates(self, measured_m):
        """Z of every layer, in units of range_scale_m."""
        l = measured_m[self.rows.below] / self.scale_m
        z, results, weight = torch.zeros_like(l), [], self.rows.mask * self.alpha
        for k in range(self.count):
            h = (weight * l + z) / (weight + 1.0)
            z = self.layers[k % len(self.layers)](h[None, None])[0, 0]
            results.append(z)
        return results

    def self_test(self, measured_m):
        """The last Z as it is, metres."""
        return self.iterates(measured_m)[-1] * self.scale_m

    def forward(self, measured_m):
        """measured_m: measured rows x columns, metres, 0 = no return. All rows: range_m before the
        filter at the end; measured rows as they were."""
        range_m = self.self_test(measured_m)
        range_m[self.rows.measured] = measured_m
        return {"range_m": range_m}
