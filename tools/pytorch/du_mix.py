"""DU-Mix (nn/hqs/two_modes_prior.h) as a PyTorch module, for several scans at a time.

What is said of computed pixels is scans x computed pixels of a tile x rows of tiles x columns of tiles.
"""

import math

import torch
from torch import nn

from layers import FromWeights, Rows, circular_conv, elevations_rad

GAIN, TYPICAL_RANGE_M, LARGEST_RECALL = 4.0, 20.0, 2.0


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
        self.has_memory = denoiser.get("scan_memory", False)
        self.rows, self.exponent = Rows(network), network.get("confidence_exponent", 1.0)
        self.offset = self.rows.measured[0]
        computed = [i for i in range(self.rows.count) if i not in self.rows.measured]
        of_computed = {  # and the measured rows that each lies between
            "computed": torch.tensor(computed),
            "above": torch.tensor([self.rows.above[i] for i in computed]),
            "below": torch.tensor([self.rows.below[i] for i in computed]),
            "part": self.rows.part_down(elevations_rad(network))[computed]}
        for name, value in of_computed.items():
            self.register_buffer(name, value, persistent=False)
        self.pixels = (self.tile[0] - 1) * self.tile[1]
        self.outputs = 9 if self.has_memory else 7
        pixels = self.tile[0] * self.tile[1]
        inputs = pixels + 2 * self.tile[1] + (2 * pixels if self.has_memory else 0)
        self.layers = nn.ModuleList([Layer(inputs, self.outputs * self.pixels,
                                           self.rows.count // self.tile[0], shape)
                                     for shape in denoiser["layers"]])  # one
        self.limits_m = network["sensor"]["min_range_m"], network["sensor"]["max_range_m"]
        self.double()

    def filled(self, measured_m):
        """No return takes the range above it; at the top, a typical one."""
        rows, above = [], torch.full_like(measured_m[:, 0], TYPICAL_RANGE_M)
        for row in measured_m.unbind(1):
            above = torch.where(row > 0.0, row, above)
            rows.append(above)
        return torch.stack(rows, 1)

    def tiles_of(self, image, rows):
        """Some rows of each tile: scans x rows x columns -> scans x channels x tiles."""
        scans, wide = len(image), image.shape[2] // self.tile[1]
        parts = image.reshape(scans, -1, rows, wide, self.tile[1])
        return parts.permute(0, 2, 4, 1, 3).flatten(1, 2)

    def rows_of(self, tiles):
        """And back."""
        parts = tiles.unflatten(1, (-1, self.tile[1]))
        return parts.permute(0, 3, 1, 4, 2).flatten(3, 4).flatten(1, 2)

    def computed_of(self, image):
        return self.tiles_of(image[:, self.computed], self.tile[0] - 1)

    def whole(self, computed, measured):
        """Both kinds of rows in their places: scans x rows x columns."""
        by_tile = computed.unflatten(1, (-1, self.tile[0] - 1))
        above, below = by_tile[:, :, : self.offset], by_tile[:, :, self.offset :]
        return torch.cat([above, measured[:, :, None], below], 2).flatten(1, 2)

    def recalled_of(self, recalled, start, log_filled):
        """What memory says beside what the scan says, in logarithms, and W^2 / (W^2 + 1)."""
        m, weight = recalled
        there = (m > 0.0) & (weight > 0.0)
        share = torch.where(there, weight / (weight + 1.0), 0.0)
        own = self.whole(start, log_filled)
        return torch.where(there, torch.where(there, m, 1.0).log() - own, 0.0), share

    def modes(self, outputs, seen):
        """What the outputs say of the computed pixels (two_modes.h)."""
        o = outputs.unflatten(1, (self.outputs, self.pixels)).unbind(1)

        def mode(side, first, recall):
            middle = seen["middle"]
            if self.has_memory:
                bounded = o[recall].clamp(-LARGEST_RECALL, LARGEST_RECALL)
                scaled = seen["recalled_share"] * torch.exp(GAIN * bounded)
                part = scaled / (scaled + 1.0 - seen["recalled_share"])
                middle = seen["start"] + part * seen["recalled_step"]
            share = torch.sigmoid(GAIN * o[first])
            return share * seen[side] + (1.0 - share) * middle + o[first + 1]

        return {
            "mode1": mode("above", 0, 7),
            "mode2": mode("below", 2, 8),
            "weight1": torch.sigmoid(GAIN * o[4]),
            "scale": torch.exp(-3.5 + 4.0 * o[5].clamp(-0.5, 1.0)),
            "probability": torch.sigmoid(GAIN * o[6]),
        }

    def say(self, measured_m, recalled=None):
        """The modes and `middle`, the logarithm of the range that is chosen. measured_m: scans x
        measured rows x columns; recalled: M (metres) and W^2, scans x all rows x columns."""
        filled = self.filled(measured_m)
        above, below = filled[:, self.above], filled[:, self.below]
        start = -torch.log((1.0 - self.part) / above + self.part / below)
        log_filled, middle = filled.log(), start
        step = torch.cat([log_filled[:, :1], log_filled[:, :-1]], 1) - log_filled
        x = [(measured_m > 0.0).to(measured_m.dtype) - 0.5, step.clamp(-1.0, 1.0)]
        x = [self.tiles_of(image, 1) for image in x]
        seen = {"above": above.log(), "below": below.log(), "start": start}
        if self.has_memory:
            if recalled is None:
                recalled = [torch.zeros_like(self.whole(start, log_filled))] * 2
            recalled_step, share = self.recalled_of(recalled, start, log_filled)
            seen["recalled_step"] = recalled_step[:, self.computed]
            seen["recalled_share"] = share[:, self.computed]
            middle = start + seen["recalled_share"] * seen["recalled_step"]
            both = [recalled_step.clamp(-1.0, 1.0), share - 0.5]
            x.append(torch.stack([self.tiles_of(i, self.tile[0]) for i in both], 2).flatten(1, 2))
        h = 0.5 * (self.whole(middle, log_filled) - math.log(TYPICAL_RANGE_M))
        seen["middle"] = middle
        seen = {name: self.tiles_of(image, self.tile[0] - 1) for name, image in seen.items()}
        x.insert(0, self.tiles_of(h, self.tile[0]))
        said = self.modes(self.layers[0](torch.cat(x, 1), self.slope), seen)
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

    def forward(self, measured_m, recalled=None, tolerance_m=0.5):
        """As `say`. Scans x all rows x columns: range_m and confidence, nothing emptied but what the
        sensor cannot see."""
        said = self.say(measured_m, recalled)
        range_m = said["middle"].exp()
        seen = ((range_m >= self.limits_m[0]) & (range_m <= self.limits_m[1])).to(range_m.dtype)
        valid = (measured_m > 0.0).to(range_m.dtype)
        confidence = self.rows_of(self.confidence(said, tolerance_m) * seen)
        return {"range_m": self.whole(self.rows_of(range_m * seen), measured_m),
                "confidence": self.whole(confidence, valid)}

    def self_test(self, measured_m):
        return self(measured_m[None])["range_m"][0]

    def loss(self, measured_m, truth_m, recalled=None):
        """The training loss, mean over the scans; truth_m: scans x all rows x columns."""
        there = self.computed_of((truth_m > 0.0).to(truth_m.dtype))
        truth = self.computed_of(torch.where(truth_m > 0.0, truth_m, torch.ones_like(truth_m)).log())
        said = self.say(measured_m, recalled)
        far1, far2 = ((truth - said[mode]).abs() / said["scale"] for mode in ("mode1", "mode2"))
        near = torch.minimum(far1, far2)  # taken out of the exponentials, of which one is then 1
        density = (said["weight1"] * torch.exp(near - far1) +
                   (1.0 - said["weight1"]) * torch.exp(near - far2)).clamp(min=1e-30)
        likely = torch.where(there > 0.0, said["probability"], 1.0 - said["probability"])
        loss = 0.3 * there * (said["scale"].log() + near - density.log())
        return (loss - likely.clamp(min=1e-7).log()).mean()
