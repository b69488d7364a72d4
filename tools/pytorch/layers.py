"""What the networks share: images of rows and tiles, and what a weights file says of its network."""

import json

import numpy
import torch
from torch.nn import functional


def describe(path):
    """The network's description (a dictionary) and its arrays (tensors by name) of a weights file."""
    with numpy.load(path) as arrays:
        network = json.loads(bytes(arrays["description"]).decode())["network"]
        tensors = {name: torch.from_numpy(arrays[name]) for name in arrays.files
                   if name != "description" and not name.startswith("self_test.")}
    return network, tensors


class FromWeights(torch.nn.Module):
    """A network that is made from its description."""

    @classmethod
    def load(cls, path, *arguments):
        """With the arrays of a weights file; `arguments`: what cls takes after the description."""
        network, tensors = describe(path)
        module = cls(network, *arguments)
        module.load_state_dict(tensors)
        return module.eval()


def save_arrays(path, module, measured_m):
    """For `hqslam weights pack`: the state dict, and what the module makes of measured rows."""
    arrays = {name: value.detach() for name, value in module.state_dict().items()}
    with torch.no_grad():
        arrays["self_test.expected"] = module.self_test(measured_m)
    arrays["self_test.measured"] = measured_m
    numpy.savez_compressed(path, **{name: value.float().numpy() for name, value in arrays.items()})


def elevations_rad(network):
    return torch.deg2rad(torch.tensor(network["sensor"]["beam_elevation_deg"], dtype=torch.float64))


class Rows:
    """Which rows of the whole image are measured, and between which two of them each row lies."""

    def __init__(self, network):
        self.count = len(network["sensor"]["beam_elevation_deg"])
        first, self.stride = network["measured_rows"]["offset"], network["measured_rows"]["stride"]
        self.measured = list(range(first, self.count, self.stride))
        self.above = [max([i for i, m in enumerate(self.measured) if m <= row], default=0)
                      for row in range(self.count)]
        self.below = [min([i for i, m in enumerate(self.measured) if m >= row],
                          default=len(self.measured) - 1) for row in range(self.count)]
        self.mask = torch.zeros(self.count, 1, dtype=torch.float64)
        self.mask[self.measured] = 1.0

    def part_down(self, position):
        """How far each row lies from the measured one above to the one below, by a position per row;
        0 where both are the same."""
        part = torch.zeros(self.count, 1, dtype=torch.float64)
        for row, (above, below) in enumerate(zip(self.above, self.below)):
            if above != below:
                top, bottom = position[self.measured[above]], position[self.measured[below]]
                part[row] = float((position[row] - top) / (bottom - top))
        return part


def to_tiles(image, tile):
    """rows x columns -> 1 x (tile rows x tile columns) x rows of tiles x columns of tiles."""
    rows, columns = tile
    high, wide = image.shape[0] // rows, image.shape[1] // columns
    return image.reshape(high, rows, wide, columns).permute(1, 3, 0, 2).reshape(1, -1, high, wide)


def from_tiles(tiles, tile):
    rows, columns = tile
    high, wide = tiles.shape[2:]
    return tiles.reshape(rows, columns, high, wide).permute(2, 0, 3, 1).reshape(
        high * rows, wide * columns)


def circular_conv(x, layer, stride=1):
    """A 3 x 3 convolution whose columns go on round the scan; zeros beyond the first and last row."""
    x = functional.pad(functional.pad(x, (1, 1, 0, 0), mode="circular"), (0, 0, 1, 1))
    return functional.conv2d(x, layer.weight, layer.bias, stride)
