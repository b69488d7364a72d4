"""DU-OR (nn/hqs/u_shaped_prior.h) as a PyTorch module."""

import torch
from torch import nn
from torch.nn import functional

from layers import FromWeights, Rows, circular_conv, from_tiles, to_tiles

GROUPS, GAIN = 5, 4.0


class UShaped(nn.Module):
    def __init__(self, denoiser, pixels):
        super().__init__()
        c, memory = denoiser["channels"], denoiser["memory"]
        inputs = [pixels + memory, *c[:-1]]
        self.encoder = nn.ModuleList([nn.Conv2d(a, b, 3) for a, b in zip(inputs, c)])
        self.bottleneck = nn.Conv2d(c[-1], c[-1], 3)
        # By level, the highest first, as in the names; they run from the lowest up.
        self.decoder = nn.ModuleList([nn.ConvTranspose2d(b, a, 2, 2) for a, b in zip(c, c[1:])])
        self.head = nn.Conv2d(c[0], GROUPS * pixels + memory, 1)

    def forward(self, x, slope):
        levels = []
        for i, layer in enumerate(self.encoder):
            x = functional.leaky_relu(circular_conv(x, layer, 2 if i else 1), slope)
            levels.append(x)
        x = functional.leaky_relu(circular_conv(x, self.bottleneck), slope)
        for layer, skip in zip(reversed(self.decoder), reversed(levels[:-1])):
            x = functional.leaky_relu(layer(x) + skip, slope)
        return self.head(x)


class DuOr(FromWeights):
    """find_outliers(H as a numpy array, units of range_scale_m) -> mask of rejected pixels: the
    filter of eq. 10c (nn/include/hqslam/nn/hqs/outlier_removal.h), needed if the network has one."""

    def __init__(self, network, find_outliers=None):
        super().__init__()
        self.find_outliers = find_outliers
        if find_outliers is None and network["filter"]["min_pixels"] > 0:
            raise ValueError("the network was trained with a filter inside: give find_outliers")
        denoiser = network["denoiser"]
        other = {"rejected_pixel": "takes-z", "filtered_iterate": "h", "penalty": None}
        for name, usual in other.items():
            if network.get(name, usual) != usual:
                raise ValueError(f"{name} {network[name]}: this module has {usual} alone")
        self.slope, self.memory = denoiser["negative_slope"], denoiser["memory"]
        self.tile = (denoiser["tile_rows"], denoiser["tile_columns"])
        self.scale_m, self.rows, self.count = network["range_scale_m"], Rows(network), network["layers"]
        self.part = self.rows.part_down(torch.arange(self.rows.count, dtype=torch.float64))
        own = 1 if network["shared_weights"] else self.count
        self.layers = nn.ModuleList(
            [UShaped(denoiser, self.tile[0] * self.tile[1]) for _ in range(own)])
        self.log_penalty = nn.Parameter(torch.zeros(self.count))
        self.limits_m = network["sensor"]["min_range_m"], network["sensor"]["max_range_m"]
        self.double()

    def start(self, above, below):
        """Linear between two returns, the nearer row where one is missing."""
        nearer = torch.where(self.part < 0.5, above, below)
        mixed = (1.0 - self.part) * above + self.part * below
        return torch.where((above > 0.0) & (below > 0.0), mixed, nearer)

    def iterates(self, measured_m):
        """Z of every layer, in units of range_scale_m, and the masks of rejected pixels."""
        scaled = measured_m / self.scale_m
        above, below = scaled[self.rows.above], scaled[self.rows.below]
        z = y = self.start(above, below)
        high, wide = self.rows.count // self.tile[0], measured_m.shape[1] // self.tile[1]
        memory, results, masks = z.new_zeros(1, self.memory, high, wide), [], []
        for k in range(self.count):
            b = torch.exp(self.log_penalty[k])
            h = (self.rows.mask * below + b * (z + y)) / (self.rows.mask + 2.0 * b)  # eq. 10a
            x = torch.cat([to_tiles(h, self.tile), memory], 1)
            output = self.layers[k % len(self.layers)](x, self.slope)
            pixels = self.tile[0] * self.tile[1]
            scores = torch.stack([from_tiles(output[:, g * pixels : (g + 1) * pixels], self.tile)
                                  for g in range(GROUPS)])
            memory = output[:, GROUPS * pixels :]
            weights = torch.softmax(GAIN * scores[:4], 0)
            z = weights[0] * above + weights[1] * below + weights[2] * h + scores[4]  # eq. 10b
            y = h
            if self.find_outliers is not None:
                masks.append(torch.from_numpy(self.find_outliers(h.detach().numpy())))
                y = torch.where(masks[-1], z, h)  # eq. 10c
            results.append(z)
        return results, masks

    def self_test(self, measured_m):
        """The last Z as it is, metres."""
        return self.iterates(measured_m)[0][-1] * self.scale_m

    def forward(self, measured_m):
        """measured_m: measured rows x columns, metres, 0 = no return. All rows: range_m before the
        filter at the end."""
        range_m = self.self_test(measured_m)
        seen = (range_m >= self.limits_m[0]) & (range_m <= self.limits_m[1])
        range_m = torch.where(seen, range_m, torch.zeros_like(range_m))
        range_m[self.rows.measured] = measured_m
        return {"range_m": range_m}


def l1_loss(rows, z, truth):
    """Of one layer's Z: the mean over all pixels, measured rows count as exact."""
    return ((1.0 - rows.mask) * (z - truth).abs()).mean()
