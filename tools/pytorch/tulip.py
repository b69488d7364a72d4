"""TULIP (Yang et al., "TULIP: Transformer for upsampling of LiDAR point clouds", CVPR 2024) as a PyTorch
module, with its names; scans x channels x rows x columns between the parts, channels last in linear
layers and norms."""

import torch
from torch import nn
from torch.nn import functional

from layers import FromWeights, Rows

EPSILON = 1e-6
WINDOW = (2, 8)


def last(x):
    return x.permute(0, 2, 3, 1)


def first(x):
    return x.permute(0, 3, 1, 2)


def merged(x):
    """2 x 2 patches into channels."""
    return torch.cat([x[..., i::2, j::2] for j in (0, 1) for i in (0, 1)], 1)


class WindowAttention(nn.Module):
    def __init__(self, channels, heads, shifted, circular):
        super().__init__()
        places = (2 * WINDOW[0] - 1) * (2 * WINDOW[1] - 1)
        self.relative_position_bias_table = nn.Parameter(0.02 * torch.randn(places, heads))
        self.qkv, self.proj = nn.Linear(channels, 3 * channels), nn.Linear(channels, channels)
        self.options = heads, shifted, circular

    @staticmethod
    def of_projections(x, table, heads, shifted, circular):
        """x: queries, keys and values in the channels."""
        (rows, columns), (high, wide) = x.shape[2:], WINDOW
        shift = (high // 2, wide // 2) if shifted else (0, 0)
        x = torch.roll(x, (-shift[0], -shift[1]), (2, 3))
        parts = x.reshape(len(x), 3, heads, -1, rows // high, high, columns // wide, wide)
        q, k, v = parts.permute(1, 0, 4, 6, 2, 5, 7, 3).flatten(5, 6)
        row = torch.arange(high).repeat_interleave(wide)
        column = torch.arange(wide).repeat(high)
        place = ((row[:, None] - row + high - 1) * (2 * wide - 1) + column[:, None] - column + wide - 1)
        scores = q @ k.transpose(-2, -1) / q.shape[-1] ** 0.5 + table[place].permute(2, 0, 1)
        end = torch.zeros(rows, columns)
        end[rows - shift[0]:] += 2.0
        if not circular:
            end[:, columns - shift[1]:] += 1.0
        end = end.reshape(rows // high, high, columns // wide, wide).permute(0, 2, 1, 3).flatten(2)
        apart = end[..., :, None] != end[..., None, :]
        weights = (scores - 100.0 * apart[:, :, None]).softmax(-1)
        x = (weights @ v).unflatten(4, WINDOW).permute(0, 3, 6, 1, 4, 2, 5)
        return torch.roll(x.reshape(len(x), -1, rows, columns), shift, (2, 3))

    def forward(self, x):
        x = self.of_projections(first(self.qkv(x)), self.relative_position_bias_table, *self.options)
        return self.proj(last(x))


class Block(nn.Module):
    def __init__(self, channels, heads, shifted, circular):
        super().__init__()
        self.norm1, self.norm2 = (nn.LayerNorm(channels, EPSILON) for _ in range(2))
        self.attn = WindowAttention(channels, heads, shifted, circular)
        self.mlp = nn.ModuleDict({"fc1": nn.Linear(channels, 4 * channels),
                                  "fc2": nn.Linear(4 * channels, channels)})

    def forward(self, x):
        x = x + self.attn(self.norm1(x))
        return x + self.mlp["fc2"](functional.gelu(self.mlp["fc1"](self.norm2(x))))


def expansion(channels):
    return nn.ModuleDict({"expand": nn.Conv2d(channels, 2 * channels, 1)})


class Stage(nn.Module):
    def __init__(self, channels, heads, circular, down=False, up=False):
        super().__init__()
        self.blocks = nn.ModuleList([Block(channels, heads, i == 1, circular) for i in range(2)])
        if down:
            self.downsample = nn.ModuleDict({
                "norm": nn.LayerNorm(4 * channels, EPSILON),
                "reduction": nn.Linear(4 * channels, 2 * channels, bias=False)})
        if up:
            self.upsample = expansion(channels)

    def forward(self, x):
        x = last(x)
        for block in self.blocks:
            x = block(x)
        x = first(x)
        if hasattr(self, "downsample"):
            x = self.downsample["norm"](last(merged(x)))
            return first(self.downsample["reduction"](x))
        return functional.pixel_shuffle(self.upsample["expand"](x), 2) if hasattr(self, "upsample") else x


class Tulip(FromWeights):
    def __init__(self, network):
        super().__init__()
        self.scale_m, self.rows = network["range_scale_m"], Rows(network)
        heads, circular = network["heads"], network["circular_attention"]
        c, stages = [network["channels"] * 2**i for i in range(len(heads))], len(heads)
        self.patch_embed = nn.ModuleDict({"proj": nn.Conv2d(1, c[0], (1, 8), (1, 4)),
                                          "norm": nn.LayerNorm(c[0], EPSILON)})
        self.layers = nn.ModuleList([Stage(c[i], heads[i], circular, down=i + 1 < stages)
                                     for i in range(stages)])
        self.first_patch_expanding = expansion(c[-1])
        up = range(stages - 2, -1, -1)
        self.skip_connection_layers = nn.ModuleList([nn.Linear(2 * c[i], c[i]) for i in up])
        self.layers_up = nn.ModuleList([Stage(c[i], heads[i], circular, up=i > 0) for i in up])
        self.norm_up = nn.LayerNorm(c[0], EPSILON)
        self.ps_head = nn.ModuleDict({"conv_expand": nn.Sequential(nn.Conv2d(c[0], 16 * c[0], 1))})
        self.decoder_pred = nn.Conv2d(c[0], 1, 1, bias=False)
        self.double()

    def image(self, measured_m):
        """measured_m: scans x rows x columns; the result: ln(1 + range / range_scale_m)."""
        x = functional.pad(torch.log1p(measured_m[:, None] / self.scale_m), (2, 2, 0, 0), mode="circular")
        x = first(self.patch_embed["norm"](last(self.patch_embed["proj"](x))))
        sides = []
        for layer in self.layers:
            sides.append(x)
            x = layer(x)
        x = functional.pixel_shuffle(self.first_patch_expanding["expand"](x), 2)
        for skip, layer, side in zip(self.skip_connection_layers, self.layers_up, sides[-2::-1]):
            x = layer(first(skip(last(torch.cat([x, side], 1)))))
        x = self.ps_head["conv_expand"](first(self.norm_up(last(x))))
        x = functional.pixel_shuffle(functional.leaky_relu(x, 0.01), 4)
        return self.decoder_pred(x)[:, 0]

    def loss(self, measured_m, truth_m):
        """Of each scan: the mean over all pixels, no return counting as 0."""
        return (self.image(measured_m) - torch.log1p(truth_m / self.scale_m)).abs().mean((1, 2))

    def self_test(self, measured_m):
        """Metres; what is below 0 as it is."""
        return torch.expm1(self.image(measured_m[None])[0]) * self.scale_m

    def forward(self, measured_m):
        """measured_m: measured rows x columns, metres, 0 = no return. All rows: range_m, measured rows
        as they were."""
        range_m = self.self_test(measured_m).clamp(min=0.0)
        range_m[self.rows.measured] = measured_m
        return {"range_m": range_m}
