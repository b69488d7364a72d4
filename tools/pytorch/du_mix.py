"""DU-Mix (nn/src/hqs/two_modes_prior.h) as a PyTorch module."""

import math

import torch
from torch import nn

from layers import FromWeights, Rows, circular_conv, elevations_rad

OUTPUTS, GAIN, TYPICAL_RANGE_M = 7, 4.0, 20.0


class Layer(nn.Module):
    def __init__(self, inputs, outputs, tile_rows, shape):
        super().__init__()
        channels, lower = shape["channels"], shape["lower_channels"]
        self.encoder = nn.ModuleList([nn.Conv2d(inputs, channels, 3), nn.Conv2d(channels, lower, 3)])
        self.encoder[0].row_bias = nn.Parameter(torch.zeros(channels, tile_rows))
        self.bottleneck = nn.ModuleList(
            [nn.Conv2d(lower, lower, 3) for _ in range(1 + shape["residual_blocks"])])
        self.decoder = nn.ModuleList([nn.ConvTranspose2d(lower, channels, 2, 2)])
        self.head = nn.Conv2d(channels, outputs, 1)

    def forward(self, x, slope):
        def activated(v):
            return torch.maximum(v, slope * v)

        row_bias = self.encoder[0].row_bias[None, :, :, None]
        encoded = activated(circular_conv(x, self.encoder[0]) + row_bias)
        x = activated(circular_conv(encoded, self.encoder[1], 2))
        for block, layer in enumerate(self.bottleneck):
            y = circular_conv(x, layer)
            x = activated(y + x) if block else activated(y)
        return self.head(activated(self.decoder[0](x) + encoded))


def share_below(v):
    """The share of a Laplace distribution of scale 1 that lies below v."""
    tail = 0.5 * torch.exp(-v.abs())
    return torch.where(v > 0, 1.0 - tail, tail)


class DuMix(FromWeights):
    def __init__(self, network):
        super().__init__()
        denoiser = network["denoiser"]
        self.slope = denoiser["negative_slope"]
        self.tile = (denoiser["tile_rows"], denoiser["tile_columns"])
        self.rows, self.exponent = Rows(network), network.get("confidence_exponent", 1.0)
        self.part = self.rows.part_down(elevations_rad(network))
        row_in_tile = torch.arange(self.rows.count) % self.tile[0]
        self.computed = [i for i in range(self.tile[0]) if i != int(row_in_tile[self.rows.measured[0]])]
        self.pixels = len(self.computed) * self.tile[1]
        inputs = self.tile[0] * self.tile[1] + 2 * self.tile[1]
        self.layers = nn.ModuleList([Layer(inputs, OUTPUTS * self.pixels,
                                           self.rows.count // self.tile[0], shape)
                                     for shape in denoiser["layers"]])  # one
        self.limits_m = network["sensor"]["min_range_m"], network["sensor"]["max_range_m"]
        self.double()

    def filled(self, measured_m):
        """No return takes the range above it; at the top, a typical one."""
        rows, above = [], torch.full_like(measured_m[0], TYPICAL_RANGE_M)
        for row in measured_m:
            above = torch.where(row > 0.0, row, above)
            rows.append(above)
        return torch.stack(rows)

    def computed_of(self, image):
        """The computed rows of all tiles: tile rows x rows of tiles x columns."""
        by_tile = image.reshape(-1, self.tile[0], image.shape[1])
        return by_tile[:, self.computed].transpose(0, 1)

    def tiles_of(self, rows):
        """rows of a tile x rows of tiles x columns -> 1 x channels x rows x columns of tiles."""
        n, high, columns = rows.shape
        wide = columns // self.tile[1]
        return rows.reshape(n, high, wide, self.tile[1]).permute(0, 3, 1, 2).reshape(1, -1, high, wide)

    def rows_of(self, tiles):
        high, wide = tiles.shape[2:]
        rows = tiles.reshape(-1, self.tile[1], high, wide).permute(0, 2, 3, 1)
        return rows.reshape(rows.shape[0], high, wide * self.tile[1])

    def modes(self, outputs, above, below, middle):
        """What the outputs say of the computed pixels (two_modes.h)."""
        o = [self.rows_of(outputs[:, g * self.pixels : (g + 1) * self.pixels]) for g in range(OUTPUTS)]
        shares = torch.sigmoid(GAIN * o[0]), torch.sigmoid(GAIN * o[2])
        return {
            "mode1": shares[0] * above + (1.0 - shares[0]) * middle + o[1],
            "mode2": shares[1] * below + (1.0 - shares[1]) * middle + o[3],
            "weight1": torch.sigmoid(GAIN * o[4]),
            "scale": torch.exp(-3.5 + 4.0 * o[5].clamp(-0.5, 1.0)),
            "probability": torch.sigmoid(GAIN * o[6]),
        }

    def say(self, measured_m):
        """The modes and `middle`, the logarithm of the range that is chosen."""
        valid, filled = (measured_m > 0.0).to(measured_m.dtype), self.filled(measured_m)
        above_m, below_m = filled[self.rows.above], filled[self.rows.below]
        start = -torch.log((1.0 - self.part) / above_m + self.part / below_m)
        above, below = self.computed_of(above_m.log()), self.computed_of(below_m.log())
        middle = self.computed_of(start)
        up = [max(0, i - 1) for i in range(len(filled))]
        step = (filled[up].log() - filled.log()).clamp(-1.0, 1.0)
        h = torch.cat([middle, filled[None].log()]) - math.log(TYPICAL_RANGE_M)
        x = [self.tiles_of(0.5 * h), self.tiles_of(valid[None] - 0.5), self.tiles_of(step[None])]
        said = self.modes(self.layers[0](torch.cat(x, 1), self.slope), above, below, middle)
        chosen = torch.where(said["weight1"] >= 0.5, said["mode1"], said["mode2"])
        return {**said, "middle": chosen}

    def confidence(self, said, tolerance_m):
        range_m, first = said["middle"].exp(), said["weight1"] >= 0.5
        farther = torch.log(1.0 + tolerance_m / range_m) / said["scale"]
        nearer = -torch.log((1.0 - tolerance_m / range_m).clamp(min=1e-6)) / said["scale"]
        other = torch.where(first, said["mode2"], said["mode1"])
        gap = (other - said["middle"]) / said["scale"]
        chosen = torch.where(first, said["weight1"], 1.0 - said["weight1"])
        within = chosen * (share_below(farther) - share_below(-nearer))
        within = within + (1.0 - chosen) * (share_below(farther - gap) - share_below(-nearer - gap))
        return (said["probability"] * within) ** self.exponent

    def forward(self, measured_m, tolerance_m=0.5):
        """measured_m: measured rows x columns, metres, 0 = no return. All rows: range_m and
        confidence, nothing emptied but what the sensor cannot see."""
        said = self.say(measured_m)
        range_m, result = said["middle"].exp(), {}
        seen = ((range_m >= self.limits_m[0]) & (range_m <= self.limits_m[1])).to(range_m.dtype)
        for name, values in (("range_m", range_m * seen),
                             ("confidence", self.confidence(said, tolerance_m) * seen)):
            own = measured_m if name == "range_m" else (measured_m > 0.0).to(values.dtype)
            tiles = own.new_zeros(len(own), self.tile[0], own.shape[1])
            tiles[:, self.computed] = values.transpose(0, 1)
            image = tiles.reshape(-1, own.shape[1])
            image[self.rows.measured] = own
            result[name] = image
        return result

    def self_test(self, measured_m):
        return self(measured_m)["range_m"]

    def loss(self, measured_m, truth_m):
        """The training loss; measured rows x columns and all rows x columns."""
        there = self.computed_of((truth_m > 0.0).to(truth_m.dtype))
        truth = self.computed_of(torch.where(truth_m > 0.0, truth_m, torch.ones_like(truth_m)).log())
        said = self.say(measured_m)
        far1, far2 = ((truth - said[mode]).abs() / said["scale"] for mode in ("mode1", "mode2"))
        near = torch.minimum(far1, far2)  # taken out of the exponentials, of which one is then 1
        density = (said["weight1"] * torch.exp(near - far1) +
                   (1.0 - said["weight1"]) * torch.exp(near - far2)).clamp(min=1e-30)
        likely = torch.where(there > 0.0, said["probability"], 1.0 - said["probability"])
        loss = 0.3 * there * (said["scale"].log() + near - density.log())
        return (loss - likely.clamp(min=1e-7).log()).mean()
