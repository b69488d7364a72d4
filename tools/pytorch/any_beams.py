"""DU-Mix for any table of beams (nn/hqs/beam_parameters.h) as a PyTorch module.

It takes several images at a time. An image has a row for each beam of a sensor, or it is a canvas:
several sensors, each below the one before it, two empty rows between them. Sensors have an even
number of beams. A layout describes the rows of images, images x rows x ...:
    there           1 where the row is a beam, 0 where it is empty
    top, bottom     the first and the last row of the sensor that the row belongs to
    psi             the beam's place among the others: 7 values
  and for the computed rows of the beam's tile:
    phi             the row's place among the beams: 22 values
    is_above        whether it is above the beam of its tile
    part            its distance from the beam above in gaps between that one and the next, 0 to 1
    share           its share in the loss, 1 for all of a sensor; 0: there is no such row
What is said of computed pixels is images x rows x computed rows of a tile x columns.
"""

import math

import numpy
import torch
from torch import nn
from torch.nn import functional

import du_mix
from du_mix import GAIN, TYPICAL_RANGE_M
from layers import FromWeights, circular_conv

USUAL_GAP_DEG, USUAL_ELEVATION_DEG, USUAL_COLUMN_STEP_DEG = 1.5, 20.0, 0.35
TRAINED_DEG = -48.5, 45.0  # elevations beyond count as the nearest of these
PSI, PHI, OUTPUTS = 7, 22, 7


def layout_of(elevation_deg, offset, stride, columns):
    """Of an image of one sensor, of which every stride-th row from offset on is measured; without
    the dimension of images."""
    elevation_deg = numpy.asarray(elevation_deg, dtype=float)
    places = numpy.clip(elevation_deg, *TRAINED_DEG) / USUAL_ELEVATION_DEG
    beams_deg, e = elevation_deg[offset::stride], places[offset::stride]
    own, last = numpy.arange(len(e)), len(e) - 1
    gaps = numpy.log((beams_deg[:-1] - beams_deg[1:]) / USUAL_GAP_DEG)
    gaps = numpy.pad(gaps, 1, mode="edge")  # above the first beam, ..., below the last one
    c = numpy.full(len(e), math.log(360.0 / columns / USUAL_COLUMN_STEP_DEG))
    psi = numpy.stack([gaps[:-1], gaps[1:], e, e * e, own == 0, own == last, c], 1)
    layout = {"there": numpy.ones(len(e)), "top": 0 * own, "bottom": 0 * own + last, "psi": psi}

    place, own = numpy.delete(numpy.arange(stride), offset), own[:, None]
    row, is_above = own * stride + place, numpy.broadcast_to(place < offset, (len(e), stride - 1))
    other = numpy.where(is_above, own - 1, own + 1)
    is_outside = (other < 0) | (other > last)
    g, e, o = gaps[numpy.where(is_above, own, own + 1)], places[row], is_outside.astype(float)
    distance = numpy.abs(elevation_deg[row] - beams_deg[own]) / (USUAL_GAP_DEG * numpy.exp(g))
    v = numpy.where(is_outside, 0.0, 2.0 * distance - 1.0)
    half = numpy.stack([numpy.ones_like(v), v, v**2, v**3, g, g * v, e, e * v, e * e, o,
                        o * numpy.minimum(distance, 2.0)], 2)
    phi = [half * is_above[..., None], half * ~is_above[..., None]]
    part = numpy.clip(numpy.where(is_above, 1.0 - distance, distance), 0.0, 1.0)
    return {**layout, "phi": numpy.concatenate(phi, 2), "is_above": is_above.copy(), "part": part,
            "share": numpy.full(row.shape, 1.0 / row.size)}


class Layer(du_mix.Layer):
    """Its first bias is a linear function of psi, and its head one of phi."""

    def __init__(self, inputs, outputs, shape):
        super().__init__(inputs, outputs, 1, shape)
        del self.encoder[0].row_bias
        self.encoder[0].beam_bias = nn.Parameter(torch.zeros(PSI, shape["channels"]))
        self.head.weight = nn.Parameter(torch.zeros(PHI, outputs, shape["channels"]))
        self.head.bias = nn.Parameter(torch.zeros(PHI, outputs))

    def forward(self, x, layout, slope):
        """images x inputs x rows x tiles -> images x rows x tiles x (computed rows, outputs)"""
        with torch.autocast(x.device.type, enabled=False):  # of each row, in full precision
            row_bias = layout["psi"] @ self.encoder[0].beam_bias
            weight, bias = (torch.tensordot(layout["phi"], parameter, 1).flatten(2, 3)
                            for parameter in (self.head.weight, self.head.bias))

        def activated(v, there):  # empty rows stay 0, as the rows beyond an image's first and last
            return torch.maximum(v, slope * v) * there.to(v.dtype)

        there = layout["there"][:, None, :, None]
        y = circular_conv(x, self.encoder[0])
        encoded = activated(y + row_bias.permute(0, 2, 1)[..., None].to(y.dtype), there)
        x = activated(circular_conv(encoded, self.encoder[1], 2), there[:, :, ::2])
        for block, layer in enumerate(self.bottleneck):
            y = circular_conv(x, layer)
            x = activated(y + x if block else y, there[:, :, ::2])
        x = activated(self.decoder[0](x) + encoded, there).permute(0, 2, 3, 1)
        return (x @ weight.transpose(2, 3).to(x.dtype)).to(bias.dtype) + bias[:, :, None]


class AnyBeams(FromWeights):
    """For the description's sensor, or for another: {"sensor": {"beam_elevation_deg", "columns",
    "min_range_m", "max_range_m"}, "measured_rows": {"offset", "stride"}}."""

    def __init__(self, network, other=None):
        super().__init__()
        network = {**network, **(other or {})}
        denoiser, sensor, rows = network["denoiser"], network["sensor"], network["measured_rows"]
        self.slope, self.tile_columns = denoiser["negative_slope"], denoiser["tile_columns"]
        self.layers = nn.ModuleList([  # one
            Layer(3 * self.tile_columns, OUTPUTS * self.tile_columns, shape)
            for shape in denoiser["layers"]])
        self.offset, self.exponent = rows["offset"], network.get("confidence_exponent", 1.0)
        self.limits_m = sensor["min_range_m"], sensor["max_range_m"]
        own = layout_of(sensor["beam_elevation_deg"], self.offset, rows["stride"],
                        sensor["columns"])
        self.names = list(own)
        for name, value in own.items():
            self.register_buffer(name, torch.from_numpy(value)[None], persistent=False)
        self.double()

    def filled(self, measured_m, top):
        """No return takes the range above it; at the top of a sensor, a typical one."""
        row = torch.arange(measured_m.shape[1], device=measured_m.device)[:, None]
        source = torch.where(measured_m > 0.0, row, -1).cummax(1).values
        ranges_m = measured_m.gather(1, source.clamp(min=0))
        return torch.where(source >= top[..., None], ranges_m, TYPICAL_RANGE_M).clamp(min=1e-3)

    def inputs(self, measured_m, log_filled, log_above, there):
        """images x (3 kinds x columns of a tile) x rows x tiles"""
        x = torch.stack([0.5 * (log_filled - math.log(TYPICAL_RANGE_M)),
                         (measured_m > 0.0).to(measured_m.dtype) - 0.5,
                         (log_above - log_filled).clamp(-1.0, 1.0)], 1) * there[:, None, :, None]
        return x.unflatten(3, (-1, self.tile_columns)).permute(0, 1, 4, 2, 3).flatten(1, 2)

    def say(self, measured_m, layout):
        """Of computed pixels: logarithms of both modes' ranges and of their scale; how likely it is
        that the first mode is the right one, and that there is a return, before the sigmoid."""
        log_filled = self.filled(measured_m, layout["top"]).log()
        row = torch.arange(measured_m.shape[1], device=measured_m.device)

        def rows_at(index):
            return log_filled.gather(1, index[..., None].expand_as(log_filled))

        log_above = rows_at(torch.maximum(row - 1, layout["top"]))
        log_below = rows_at(torch.minimum(row + 1, layout["bottom"]))
        x = self.inputs(measured_m, log_filled, log_above, layout["there"])
        o = self.layers[0](x, layout, self.slope)  # images x rows x tiles x (row, output, column)
        o = o.unflatten(3, (-1, OUTPUTS, self.tile_columns)).permute(4, 0, 1, 3, 2, 5).flatten(4)

        is_above, part = layout["is_above"][..., None], layout["part"][..., None]
        above = torch.where(is_above, log_above[:, :, None], log_filled[:, :, None])
        below = torch.where(is_above, log_filled[:, :, None], log_below[:, :, None])
        middle = -torch.log((1.0 - part) * torch.exp(-above) + part * torch.exp(-below))

        def mode(side, first):
            return middle + torch.sigmoid(GAIN * o[first]) * (side - middle) + o[first + 1]

        return {"mode1": mode(above, 0), "mode2": mode(below, 2), "first": GAIN * o[4],
                "log_scale": -3.5 + 4.0 * o[5].clamp(-0.5, 1.0), "returns": GAIN * o[6]}

    def forward(self, measured_m, tolerance_m=0.5):
        """Scans x beams x columns -> scans x all rows x columns: range_m and confidence, nothing
        emptied but what the sensor cannot see."""
        said = self.say(measured_m, {name: getattr(self, name) for name in self.names})
        said = {**said, "weight1": said["first"].sigmoid(), "scale": said["log_scale"].exp(),
                "probability": said["returns"].sigmoid(),
                "middle": torch.where(said["first"] >= 0.0, said["mode1"], said["mode2"])}
        range_m = said["middle"].exp()
        seen = ((range_m >= self.limits_m[0]) & (range_m <= self.limits_m[1])).to(range_m.dtype)

        def whole(computed, measured):
            above, below = computed[:, :, : self.offset], computed[:, :, self.offset :]
            return torch.cat([above, measured[:, :, None], below], 2).flatten(1, 2)

        confidence = du_mix.DuMix.confidence(self, said, tolerance_m)
        return {"range_m": whole(range_m * seen, measured_m),
                "confidence": whole(confidence * seen, (measured_m > 0.0).to(range_m.dtype))}

    def self_test(self, measured_m):
        return self(measured_m[None])["range_m"][0]

    def loss(self, measured_m, truth_m, layout):
        """DU-Mix's, mean over the sensors; truth_m: images x rows x computed rows x columns."""
        said, there = self.say(measured_m, layout), truth_m > 0.0
        truth = torch.where(there, truth_m, 1.0).log()
        far1, far2 = ((truth - said[mode]).abs() * torch.exp(-said["log_scale"])
                      for mode in ("mode1", "mode2"))
        first, second = (functional.logsigmoid(v) for v in (said["first"], -said["first"]))
        unlikely = said["log_scale"] - torch.logaddexp(first - far1, second - far2)
        unseen = -functional.logsigmoid(torch.where(there, said["returns"], -said["returns"]))
        loss = 0.3 * torch.where(there, unlikely, 0.0) + unseen
        share = layout["share"][..., None]
        return (loss * share).sum() / (share.sum() * truth_m.shape[3])
