#!/usr/bin/env python3
"""Makes the files of tests/golden with programs that are not hqslam, for its tests to compare with.

    tools/make_golden.py            all sections
    tools/make_golden.py npz ...    these sections

The files are part of the repository; nothing in the build needs this script. All sections but npz
need PyTorch.
"""

import pathlib
import sys

import numpy

if sys.argv[1:] != ["npz"]:
    import torch
    from torch.nn import functional

    sys.path.insert(0, str(pathlib.Path(__file__).parent / "pytorch"))
    import layers
    from du_mix import DuMix
    from du_or import DuOr, l1_loss
    from simple_du import SimpleDu
    from srae import Srae

GOLDEN = pathlib.Path(__file__).resolve().parent.parent / "tests" / "golden"


def make_npz():
    """Arrays of every dtype that hqslam reads, packed by numpy. tests/core/npz_test.cpp has the same
    values."""
    arrays = {
        "float32": numpy.array([[0.5, -1.25, 3.0], [numpy.inf, 1e-40, -0.0]], "<f4"),
        "float64": numpy.array([0.1, -1e300], "<f8"),
        "int64": numpy.array([[-1], [2**62]], "<i8"),
        "int32": numpy.array([-(2**31), 7], "<i4"),
        "uint8": numpy.frombuffer("Grüße".encode(), "|u1"),
        "int8": numpy.array([-128, 127], "|i1"),
        "bool": numpy.array([True, False, True], "|b1"),
        "scalar": numpy.array(42, "<i8"),
        "empty": numpy.zeros((0, 3), "<f4"),
        # Long enough that deflate has something to gain.
        "ramp": (numpy.arange(3000) % 50).astype("<f4").reshape(3, 10, 100),
        "nested/näme": numpy.array([1.0], "<f4"),
    }
    numpy.savez(GOLDEN / "numpy_stored.npz", **arrays)
    numpy.savez_compressed(GOLDEN / "numpy_deflated.npz", **arrays)


def rounded(array):
    """Values that float32 holds exactly, so that both sides start from the same."""
    return numpy.asarray(array, "<f4").astype("<f8")


def random_array(generator, *shape):
    return rounded(generator.uniform(-1.0, 1.0, shape))


def save(name, arrays):
    """Results were computed in float64; float32 is what they are compared with."""
    stored = {}
    for key, array in arrays.items():
        array = array.detach().numpy() if hasattr(array, "detach") else numpy.asarray(array)
        stored[key] = array.astype("<f4") if array.dtype == numpy.float64 else array
    numpy.savez_compressed(GOLDEN / f"{name}.npz", **stored)


# --- layers, by PyTorch in float64 -----------------------------------------------------------------


def selection(scores, above, below, here):
    """scores: above, below, here, nothing, correction."""
    weights = torch.softmax(4.0 * scores[:4], 0)
    return weights[0] * above + weights[1] * below + weights[2] * here + scores[4]


def make_layers():
    generator = numpy.random.RandomState(2)
    arrays = {}

    def tensor(name, *shape):
        value = torch.tensor(random_array(generator, *shape), requires_grad=True)
        arrays[name] = value
        return value

    def finish(name, y):
        d_y = torch.tensor(random_array(generator, *y.shape))
        y.backward(d_y)
        arrays.update({f"{name}.output": y, f"{name}.d_output": d_y})

    for slope in (0.0, 0.125):
        x = tensor(f"leaky_relu.{slope}.input", 2, 3, 20)
        finish(f"leaky_relu.{slope}", functional.leaky_relu(x, slope))
        arrays[f"leaky_relu.{slope}.d_input"] = x.grad

    image = tensor("tiles.image", 8, 24)
    arrays["tiles.4x4"] = functional.pixel_unshuffle(image[None, None], 4)[0]
    arrays["tiles.2x2"] = functional.pixel_unshuffle(image[None, None], 2)[0]

    # Tiles of 4 x 4 pixels, rows 3, 7, ... measured: channels 12 to 15.
    l, z, y = (tensor(f"data_consistency.{name}", 16, 2, 20) for name in "lzy")
    b = torch.tensor(0.375, dtype=torch.float64, requires_grad=True)
    measured = torch.zeros(16, 1, 1, dtype=torch.float64)
    measured[12:] = 1.0
    # The formula with its 0/1 diagonal D^T D, as eq. 10a has it.
    finish("data_consistency", (measured * l + b * (z + y)) / (measured + 2.0 * b))
    arrays.update({"data_consistency.d_z": z.grad, "data_consistency.d_y": y.grad,
                   "data_consistency.penalty": b.detach().reshape(1),
                   "data_consistency.d_penalty": b.grad.reshape(1)})

    scores = tensor("selection.scores", 5, 4, 2, 20)
    above, below, here = (tensor(f"selection.{name}", 4, 2, 20)
                          for name in ("above", "below", "here"))
    finish("selection", selection(scores, above, below, here))
    arrays.update({"selection.weights": torch.softmax(4.0 * scores[:4], 0),
                   "selection.d_scores": scores.grad, "selection.d_here": here.grad})

    z = tensor("l1_loss.z", 16, 2, 20)
    truth = tensor("l1_loss.truth", 16, 2, 20)
    loss = ((1.0 - measured) * (z - truth).abs()).mean()
    loss.backward()
    arrays.update({"l1_loss.loss": loss.reshape(1), "l1_loss.d_z": z.grad})
    save("layers", arrays)


def dropout_factor(seed, share, shape):
    """What hqslam's dropout multiplies with: 0 or 1 / (1 - share), from seed and place alone."""
    place = numpy.arange(1, numpy.prod(shape) + 1, dtype=numpy.uint64)
    with numpy.errstate(over="ignore"):
        v = numpy.uint64(seed) + numpy.uint64(0x9E3779B97F4A7C15) * place
        v = (v ^ (v >> numpy.uint64(30))) * numpy.uint64(0xBF58476D1CE4E5B9)
        v = (v ^ (v >> numpy.uint64(27))) * numpy.uint64(0x94D049BB133111EB)
    unit = ((v ^ (v >> numpy.uint64(31))) >> numpy.uint64(40)).astype("<f4") / numpy.float32(2**24)
    return numpy.where(unit < numpy.float32(share), 0.0, 1.0 / (1.0 - share)).reshape(shape)


class GoldenLayer:
    """One case of the section network_layers: inputs and parameters are made by tensor(), in the
    order in which hqslam has them."""

    def __init__(self, arrays, generator, name):
        self.arrays, self.generator, self.name = arrays, generator, name
        self.inputs, self.parameters = [], []

    def input(self, *shape, scale=1.0):
        values = rounded(scale * random_array(self.generator, *shape))
        self.inputs.append(torch.tensor(values, requires_grad=True))
        return self.inputs[-1]

    def parameter(self, *shape, middle=0.0):
        values = rounded(middle + random_array(self.generator, *shape) / 2.0)
        self.parameters.append(torch.tensor(values, requires_grad=True))
        return self.parameters[-1]

    def finish(self, y):
        d_y = torch.tensor(random_array(self.generator, *y.shape))
        y.backward(d_y)
        self.arrays.update({f"{self.name}.output": y, f"{self.name}.d_output": d_y})
        for i, x in enumerate(self.inputs):
            self.arrays.update({f"{self.name}.input.{i}": x, f"{self.name}.d_input.{i}": x.grad})
        if self.parameters:
            self.arrays[f"{self.name}.parameters"] = torch.cat(
                [p.detach().flatten() for p in self.parameters])
            self.arrays[f"{self.name}.d_parameters"] = torch.cat(
                [p.detach().flatten() * 0.0 if p.grad is None else p.grad.flatten()
                 for p in self.parameters])


def make_network_layers():
    """Scans x channels x rows x columns."""
    generator = numpy.random.RandomState(4)
    arrays = {}

    def case(name):
        return GoldenLayer(arrays, generator, name)

    c = case("transposed")  # strides 2 x 1
    x, weight, bias = c.input(1, 3, 4, 20), c.parameter(3, 5, 3, 3), c.parameter(5)
    c.finish(torch.relu(functional.conv_transpose2d(x, weight, bias, (2, 1), 1, (1, 0))))

    c = case("linear")  # with a skip
    x, skip, weight, bias = (c.input(1, 5, 3, 20), c.input(1, 7, 3, 20), c.parameter(7, 5),
                             c.parameter(7))
    c.finish(functional.linear(x.permute(0, 2, 3, 1), weight, bias).permute(0, 3, 1, 2) + skip)

    random_array(generator, 534)  # of a case that is gone: those below keep their values

    c = case("batch_norm")
    x = c.input(3, 4, 3, 20)
    weight, bias, mean = c.parameter(4, middle=1.0), c.parameter(4), c.parameter(4)
    variance = c.parameter(4, middle=1.0)
    running = mean.detach().clone(), variance.detach().clone()
    c.finish(functional.leaky_relu(
        functional.batch_norm(x, *running, weight, bias, True, 1.0, 1e-3), 0.125))
    # Three scans' distance to the batch's statistics, which a momentum of 1 leaves in `running`.
    mean.grad, variance.grad = 3.0 * (mean - running[0]), 3.0 * (variance - running[1])
    arrays["batch_norm.d_parameters"][8:] = torch.cat([mean.grad, variance.grad])
    arrays["batch_norm.upsampled"] = functional.leaky_relu(
        functional.batch_norm(x, mean.detach(), variance.detach(), weight, bias, False, 0.0, 1e-3),
        0.125)

    for transposed in (0, 1):  # convolution and batch norm in one
        c = case(f"normalised.{transposed}")
        x, weight, bias = c.input(1, 3, 4, 20), c.parameter(3, 3, 3, 3), c.parameter(3)
        scale, shift, mean, variance = (c.parameter(3, middle=m) for m in (1.0, 0.0, 0.0, 1.0))
        y = (functional.conv_transpose2d(x, weight, bias, 2, 1, 1) if transposed
             else functional.conv2d(x, weight, bias, 1, 1))
        c.finish(torch.relu(functional.batch_norm(y, mean.detach(), variance.detach(), scale, shift,
                                                  False, 0.0, 1e-3)))

    c = case("average_pool")
    c.finish(functional.avg_pool2d(c.input(1, 3, 4, 20), 2))

    c = case("concatenation")
    c.finish(torch.cat([c.input(1, 2, 3, 20), c.input(1, 3, 3, 20)], 1))

    c = case("dropout")
    x = c.input(1, 3, 4, 20)
    c.finish(x * torch.tensor(dropout_factor(77, 0.25, x.shape)))

    save("network_layers", arrays)


def make_adamw():
    """torch.optim.AdamW with its defaults but for a learning rate that changes."""
    generator = numpy.random.RandomState(3)
    parameters = torch.tensor(random_array(generator, 40), requires_grad=True)
    optimiser = torch.optim.AdamW([parameters])
    arrays = {"start": parameters.detach().clone()}
    rates = rounded([1e-3, 2e-3, 5e-2, 1e-2, 1e-3, 1e-4])
    gradients = random_array(generator, len(rates), 40) * 10.0 ** generator.randint(-4, 2, 40)
    gradients = rounded(gradients)
    after = []
    for rate, gradient in zip(rates, gradients):
        optimiser.param_groups[0]["lr"] = rate
        parameters.grad = torch.tensor(gradient)
        optimiser.step()
        after.append(parameters.detach().clone())
    arrays.update({"rates": rates, "gradients": gradients, "parameters": torch.stack(after)})
    save("adamw", arrays)


# --- the whole networks ----------------------------------------------------------------------------

ROWS, COLUMNS, LAYERS = 16, 64, 3
FIRST_ROW, ROW_STRIDE = 3, 4
RANGE_SCALE_M = 80.0
MIN_RANGE_M = 0.5
# The sensor of tests/nn/small_network.h.
ELEVATION_RAD = numpy.radians(6.0 - 1.5 * numpy.arange(ROWS))
COLUMN_STEP_RAD = 2.0 * numpy.pi / COLUMNS


def scene_m():
    """Walls round about, a box and poles in front of them, and no return in one corner."""
    row, column = numpy.mgrid[0:ROWS, 0:COLUMNS]
    ranges = 12.0 + 4.0 * numpy.sin(2.0 * numpy.pi * column / COLUMNS) - 0.25 * row
    ranges[5:, 20:31] = 5.0
    ranges[:, [6, 13, 37, 60]] = 3.0
    ranges[:8, 44:51] = 0.0
    return rounded(ranges)


def rejected_pixels(ranges, min_angle_rad, min_pixels):
    """Breadth-first search over the four neighbours (Bogoslavskyi & Stachniss)."""
    ranges = numpy.where(ranges >= MIN_RANGE_M / RANGE_SCALE_M, ranges, 0.0)
    measured = (numpy.arange(ROWS) - FIRST_ROW) % ROW_STRIDE == 0
    seen = numpy.zeros((ROWS, COLUMNS), bool)
    rejected = numpy.zeros((ROWS, COLUMNS), bool)
    for start in numpy.ndindex(ROWS, COLUMNS):
        if seen[start] or ranges[start] <= 0.0:
            continue
        queue = [start]
        seen[start] = True
        for row, column in queue:
            for to_row, to_column in ((row - 1, column), (row + 1, column),
                                      (row, (column - 1) % COLUMNS), (row, (column + 1) % COLUMNS)):
                if not 0 <= to_row < ROWS or seen[to_row, to_column]:
                    continue
                near, far = sorted((ranges[row, column], ranges[to_row, to_column]))
                if near <= 0.0:
                    continue
                alpha = (COLUMN_STEP_RAD if to_row == row
                         else abs(ELEVATION_RAD[row] - ELEVATION_RAD[to_row]))
                angle = numpy.arctan2(near * numpy.sin(alpha), far - near * numpy.cos(alpha))
                assert abs(angle - min_angle_rad) > 1e-5, "too close to tell in float32"
                if angle > min_angle_rad:
                    seen[to_row, to_column] = True
                    queue.append((to_row, to_column))
        if len(queue) < min_pixels:
            for row, column in queue:
                rejected[row, column] = not measured[row]
    return rejected


# Also as users export them, for `hqslam weights pack`.
EXPORTED = ("du_or", "simple_du", "du_mix")


def small_network(kind, denoiser, layers=LAYERS, shared=False, min_pixels=0):
    """As hqslam writes descriptions: the network of tests/nn/small_network.h."""
    return {
        "kind": kind, "layers": layers, "shared_weights": shared, "denoiser": denoiser,
        "sensor": {"beam_elevation_deg": list(6.0 - 1.5 * numpy.arange(ROWS)),
                   "min_range_m": MIN_RANGE_M, "max_range_m": 120.0},
        "measured_rows": {"offset": FIRST_ROW, "stride": ROW_STRIDE},
        "range_scale_m": RANGE_SCALE_M, "filter": {"min_pixels": min_pixels},
    }


def in_file_order(module):
    """The parameters as weights files have them: those of the layers first."""
    return [value for name, value in sorted(module.named_parameters(),
                                            key=lambda named: not named[0].startswith("layers."))]


def with_stored_parameters(module, seed, last=None):
    """Small fractions of 256, which a byte stores; returned as such."""
    count = sum(value.numel() for value in in_file_order(module))
    stored = numpy.random.RandomState(seed).randint(-64, 65, count).astype("|i1")
    if last is not None:
        stored[-1] = last
    values, begin = torch.tensor(stored / 256.0), 0
    with torch.no_grad():
        for value in in_file_order(module):
            value.copy_(values[begin : begin + value.numel()].reshape(value.shape))
            begin += value.numel()
    return stored


def save_network(name, module, measured_m, stored, loss, extra):
    loss.backward()
    gradient = torch.cat([value.grad.flatten() for value in in_file_order(module)])
    save(name, {"measured_m": measured_m, "parameters": stored, "loss": loss.reshape(1),
                "d_parameters": gradient, **extra})
    if name in EXPORTED:
        layers.save_arrays(GOLDEN / f"exported_{name}.npz", module, measured_m)


def unrolled(name, module, seed, last=None):
    """The loss is the one of training: measured rows count as exact."""
    measured_m = torch.tensor(scene_m()[FIRST_ROW::ROW_STRIDE])
    truth = torch.tensor(scene_m() / RANGE_SCALE_M)
    stored = with_stored_parameters(module, seed, last)
    z, masks = module.iterates(measured_m), []
    if isinstance(z, tuple):
        z, masks = z
    extra = {f"layers.{i}.z": value for i, value in enumerate(z)}
    for i, mask in enumerate(masks):
        extra[f"layers.{i}.rejected"] = mask.numpy().astype("|u1")
        assert 0.03 < mask.double().mean() < 0.7, f"a dull mask: {mask.double().mean()}"
    loss = l1_loss(module.rows, z[-1], truth)
    save_network(name, module, measured_m, stored, loss, extra)


def du_or(name, seed, channels, memory, slope, shared, min_pixels):
    def find_outliers(h):
        return rejected_pixels(h, numpy.radians(10.0), min_pixels)

    denoiser = {"tile_rows": 4, "tile_columns": 4, "channels": list(channels), "memory": memory,
                "negative_slope": slope}
    network = small_network("du-or", denoiser, shared=shared, min_pixels=min_pixels)
    unrolled(name, DuOr(network, find_outliers if min_pixels > 0 else None), seed)


def simple_du(name, seed, features, convolutions):
    denoiser = {"features": features, "convolutions": convolutions, "dropout": 0.0}
    unrolled(name, SimpleDu(small_network("simple-du", denoiser, shared=True)), seed, last=96)


def du_mix(name, seed, shape, slope, scan_memory=False):
    """shape: channels, lower channels and residual blocks."""
    fields = ("channels", "lower_channels", "residual_blocks")
    denoiser = {"tile_rows": 4, "tile_columns": 4, "memory": 0, "negative_slope": slope,
                "layers": [dict(zip(fields, shape))], "scan_memory": scan_memory}
    module = DuMix(small_network("du-mix", denoiser))
    stored = with_stored_parameters(module, seed)
    measured_m = torch.tensor(scene_m()[FIRST_ROW::ROW_STRIDE])
    measured_m[2, 30:33] = 0.0
    measured_m, truth_m = measured_m[None], torch.tensor(scene_m())[None]
    recalled, memory = None, {}
    if scan_memory:  # of two pixels in three something, often not far off
        random = numpy.random.RandomState(seed)
        off = numpy.exp(0.4 * random.randn(*scene_m().shape))
        recalled_m = rounded(scene_m() * off * (random.rand(*off.shape) < 0.67))
        weight = rounded(numpy.exp(2.0 * random.randn(*off.shape)))
        memory = {"recalled_m": recalled_m, "weight": weight}
        recalled = [torch.tensor(image)[None] for image in memory.values()]
    loss = module.loss(measured_m, truth_m, recalled)
    said = module.say(measured_m, recalled)

    def rows_of_tiles(tiles):
        return module.rows_of(tiles)[0].unflatten(0, (-1, ROW_STRIDE - 1)).transpose(0, 1)

    extra = {"range_m": rows_of_tiles(said["middle"].exp()),
             "confidence": rows_of_tiles(module.confidence(said, 0.5)), **memory}
    save_network(name, module, measured_m[0], stored, loss, extra)
    with torch.no_grad():  # as sure of its ranges as a network can be
        module.layers[0].head.bias[5 * module.pixels : 6 * module.pixels] = -1.0
    assert module.loss(measured_m, truth_m).isfinite(), "the loss of a sure network"


def passes_of(module, measured_m):
    """The ranges that Monte Carlo passes agree on, with hqslam's seeds: 64 from one pass to the next."""
    calls = []

    def dropout(x, place):
        seed = 64 * (len(calls) // 8) + place
        calls.append(seed)
        return x * torch.tensor(dropout_factor(seed, 0.25, x.shape))

    module.dropout = dropout
    with torch.no_grad():
        range_m = module(measured_m)["range_m"]
    range_m[(range_m < MIN_RANGE_M) | (range_m > 120.0)] = 0.0
    empty = (range_m == 0.0).double().mean()
    assert 0.1 < empty < 0.9, f"a dull mask: {empty}"
    return {"passes.range_m": range_m}


def direct(name, module, seed):
    """Networks that say all ranges in one go: the state dict as users export it, and what training two
    scans together gives."""
    generator = numpy.random.RandomState(seed)
    state = module.state_dict()
    for key, value in state.items():
        unit = generator.randint(-64, 65, value.shape) / 64.0
        if value.dim() > 1:
            unit *= (6.0 / value[0].numel()) ** 0.5  # so that values neither die nor explode
        elif "norm" in key and key.endswith((".weight", ".running_var")):
            unit = 1.0 + unit / 4.0
        else:
            unit = 0.25 + unit / 4.0
        value.copy_(torch.tensor(numpy.round(256.0 * unit) / 256.0))
    truth_m = torch.tensor(numpy.stack([scene_m(), numpy.roll(0.5 * scene_m(), 9, 1)]))
    measured_m = truth_m[:, FIRST_ROW::ROW_STRIDE]
    layers.save_arrays(GOLDEN / f"exported_{name}.npz", module.eval(), measured_m[0])
    assert module.self_test(measured_m[0]).std() > 1.0, "a dull result"
    upsampled = passes_of(module, measured_m[0]) if hasattr(module, "passes") else {}
    before = {key: value.clone() for key, value in state.items()}
    seeds = (5, 7000)

    def dropout(x, place):
        factors = [dropout_factor(s + place, 0.25, x.shape[1:]) for s in seeds]
        return x * torch.tensor(numpy.stack(factors))

    module.train().dropout = dropout
    loss = module.loss(measured_m, truth_m).sum()
    loss.backward()
    arrays = {"truth_m": truth_m.reshape(-1, COLUMNS), "seeds": numpy.array(seeds, "<i8"),
              "loss": loss.reshape(1), **upsampled}
    for key, value in module.named_parameters():
        arrays["d." + key] = value.grad
    for key, value in module.named_buffers():
        # Two scans' distance to the batch's statistics, by what the running ones have moved.
        arrays["d." + key] = 2.0 * (before[key] - value) / 0.01
    save(name, arrays)


def make_direct_networks():
    network = {key: value for key, value in small_network("", {}).items()
               if key in ("sensor", "measured_rows", "range_scale_m")}
    direct("srae", Srae({**network, "filters": 1, "dropout": 0.25, "passes": 4,
                         "largest_deviation": 0.1875}), 21)


def make_networks():
    du_or("du_or", 10, (6, 8), 3, 0.0, shared=False, min_pixels=0)
    du_or("du_or_filtered", 11, (6, 8), 3, 0.125, shared=True, min_pixels=30)
    simple_du("simple_du", 12, 8, 5)
    du_mix("du_mix", 13, (6, 8, 1), 0.125)
    du_mix("du_mix_memory", 14, (6, 8, 1), 0.125, scan_memory=True)


SECTIONS = {
    "npz": make_npz,
    "layers": make_layers,
    "network_layers": make_network_layers,
    "adamw": make_adamw,
    "networks": make_networks,
    "direct_networks": make_direct_networks,
}


def main(names):
    unknown = [name for name in names if name not in SECTIONS]
    if unknown:
        sys.exit(f"no section {', '.join(unknown)}; there are {', '.join(SECTIONS)}")
    GOLDEN.mkdir(exist_ok=True)
    for name in names or SECTIONS:
        SECTIONS[name]()
        print(f"{name}: made in {GOLDEN}")


if __name__ == "__main__":
    main(sys.argv[1:])
