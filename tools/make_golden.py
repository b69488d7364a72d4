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


def padded(x, rows, columns, circular):
    """Columns continue round the circle or with zeros, rows with zeros."""
    from torch.nn import functional

    if columns > 0:
        x = functional.pad(x, (columns, columns, 0, 0), mode="circular" if circular else "constant")
    return functional.pad(x, (0, 0, rows, rows))


def conv2d(x, weight, bias, stride, padding, circular):
    from torch.nn import functional

    return functional.conv2d(padded(x, *padding, circular), weight, bias, stride)


def conv_transpose2d(x, weight, bias, stride, padding, circular, rows, columns):
    """Without padding first; then rows beyond the edge are dropped and columns folded round."""
    import torch
    from torch.nn import functional

    full = functional.conv_transpose2d(x, weight, None, stride)
    full = functional.pad(full, (0, 0, 0, rows))[:, :, padding[0] : padding[0] + rows]
    if circular:
        to = (torch.arange(full.shape[3]) - padding[1]) % columns
        output = torch.zeros(*full.shape[:3], columns, dtype=full.dtype)
        output = output.index_add(3, to, full)
    else:
        output = functional.pad(full, (0, columns))[:, :, :, padding[1] : padding[1] + columns]
    return output if bias is None else output + bias[None, :, None, None]


def layer_case(arrays, name, generator, shape, wide, circular, with_bias):
    """shape: input channels, output channels, kernel rows and columns, stride, padding of both.
    wide: rows and columns of conv2d's input, of conv_transpose2d's output."""
    import torch

    inputs, outputs, kernel_rows, kernel_columns, stride, padding_rows, padding_columns = shape
    transposed = name.startswith("conv_transpose2d")
    narrow = ((wide[0] + 2 * padding_rows - kernel_rows) // stride + 1,
              wide[1] // stride if circular
              else (wide[1] + 2 * padding_columns - kernel_columns) // stride + 1)
    size_in, size_out = (narrow, wide) if transposed else (wide, narrow)
    channels = (inputs, outputs) if transposed else (outputs, inputs)
    x = torch.tensor(random_array(generator, 1, inputs, *size_in), requires_grad=True)
    weight = torch.tensor(random_array(generator, *channels, kernel_rows, kernel_columns),
                          requires_grad=True)
    bias = torch.tensor(random_array(generator, outputs), requires_grad=True) if with_bias else None
    padding = (padding_rows, padding_columns)
    if transposed:
        y = conv_transpose2d(x, weight, bias, stride, padding, circular, *wide)
    else:
        y = conv2d(x, weight, bias, stride, padding, circular)
    assert y.shape[2:] == torch.Size(size_out), (y.shape, size_out)
    d_y = torch.tensor(random_array(generator, *y.shape))
    y.backward(d_y)
    arrays.update({
        f"{name}.shape": numpy.array([*shape, *size_in, *size_out, int(circular)], "<i8"),
        f"{name}.input": x[0], f"{name}.weight": weight, f"{name}.output": y[0],
        f"{name}.d_output": d_y[0], f"{name}.d_input": x.grad[0], f"{name}.d_weight": weight.grad,
    })
    if with_bias:
        arrays.update({f"{name}.bias": bias, f"{name}.d_bias": bias.grad})


def make_convolutions():
    generator = numpy.random.RandomState(1)
    arrays = {}
    conv = [((3, 5, 3, 3, 1, 1, 1), (4, 20), True, True),
            ((3, 9, 3, 3, 2, 1, 1), (6, 24), True, True),
            ((2, 3, 3, 3, 1, 1, 1), (3, 17), False, False),
            ((4, 6, 1, 1, 1, 0, 0), (3, 16), True, True),
            ((2, 3, 4, 4, 2, 1, 1), (4, 12), True, True),
            ((2, 3, 3, 5, 1, 1, 2), (3, 8), True, False)]
    transposed = [((5, 3, 2, 2, 2, 0, 0), (4, 20), True, True),
                  ((3, 4, 4, 4, 2, 1, 1), (6, 24), True, True),
                  ((3, 2, 3, 3, 2, 1, 1), (4, 12), True, False),
                  ((3, 2, 3, 3, 1, 1, 1), (3, 17), False, True)]
    for kind, cases in (("conv2d", conv), ("conv_transpose2d", transposed)):
        for i, case in enumerate(cases):
            layer_case(arrays, f"{kind}.{i}", generator, *case)
    save("convolutions", arrays)


def selection(scores, above, below, here):
    """scores: above, below, here, nothing, correction."""
    import torch

    weights = torch.softmax(4.0 * scores[:4], 0)
    return weights[0] * above + weights[1] * below + weights[2] * here + scores[4]


def make_layers():
    import torch
    from torch.nn import functional

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


def make_adamw():
    """torch.optim.AdamW with its defaults but for a learning rate that changes."""
    import torch

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


class Parameters:
    """Small fractions of 256, which a byte stores; handed out array by array."""

    def __init__(self, generator, count):
        import torch

        self.stored = generator.randint(-64, 65, count).astype("|i1")
        self.flat = torch.tensor(self.stored / 256.0, requires_grad=True)
        self.next = 0

    def take(self, *shape):
        count = int(numpy.prod(shape))
        self.next += count
        return self.flat[self.next - count : self.next].reshape(shape)

    def conv(self, outputs, inputs, kernel):
        return self.take(outputs, inputs, kernel, kernel), self.take(outputs)


def start_images(measured):
    """Measured ranges spread over all rows: L, and the nearest measured ones above and below, and
    linear between them where both have a return, otherwise the nearer one."""
    import torch

    above, below, linear = (torch.zeros(ROWS, COLUMNS, dtype=torch.float64) for _ in range(3))
    rows = FIRST_ROW + ROW_STRIDE * numpy.arange(len(measured))
    for row in range(ROWS):
        up = max([i for i in range(len(rows)) if rows[i] <= row], default=0)
        down = min([i for i in range(len(rows)) if rows[i] >= row], default=len(rows) - 1)
        above[row], below[row] = measured[up], measured[down]
        part = (row - rows[up]) / ROW_STRIDE if up != down else 0.0
        both = (above[row] > 0.0) & (below[row] > 0.0)
        nearer = above[row] if part < 0.5 else below[row]
        linear[row] = torch.where(both, (1.0 - part) * above[row] + part * below[row], nearer)
    return above, below, linear


def to_tiles(image, tile):
    from torch.nn import functional

    return functional.pixel_unshuffle(image[None, None], tile)


def from_tiles(tiles, tile):
    from torch.nn import functional

    return functional.pixel_shuffle(tiles, tile)[0, 0]


def u_shaped(parameters, channels, memory, slope, h, remembered, above, below):
    import torch
    from torch.nn import functional

    first, second = channels

    def activated(x):
        return functional.leaky_relu(x, slope)

    def conv(x, outputs, stride):
        return activated(conv2d(x, *parameters.conv(outputs, x.shape[1], 3), stride, (1, 1), True))

    up = conv(torch.cat((to_tiles(h, 4), remembered), 1), first, 1)
    low = conv(conv(up, second, 2), second, 1)
    weight, bias = parameters.take(second, first, 2, 2), parameters.take(first)
    up = activated(functional.conv_transpose2d(low, weight, bias, 2) + up)
    output = functional.conv2d(up, *parameters.conv(80 + memory, first, 1))
    groups = output[0, :80].reshape(5, 16, *output.shape[2:])
    scores = torch.stack([from_tiles(group[None], 4) for group in groups])
    return selection(scores, above, below, h), output[:, 80:]


def measured_mask():
    import torch

    mask = torch.zeros(ROWS, 1, dtype=torch.float64)
    mask[FIRST_ROW::ROW_STRIDE] = 1.0
    return mask


def save_network(name, measured_m, truth, parameters, z, extra):
    """The loss is the one of training: measured rows count as exact."""
    loss = ((1.0 - measured_mask()) * (z[-1] - truth).abs()).mean()
    loss.backward()
    save(name, {"measured_m": measured_m, "parameters": parameters.stored, "loss": loss.reshape(1),
                "d_parameters": parameters.flat.grad, **extra,
                **{f"layers.{i}.z": value for i, value in enumerate(z)}})


def du_or(name, seed, channels, memory, slope, shared, min_pixels):
    import torch

    generator = numpy.random.RandomState(seed)
    measured_m = scene_m()[FIRST_ROW::ROW_STRIDE]
    truth = torch.tensor(scene_m() / RANGE_SCALE_M)
    above, below, linear = start_images(torch.tensor(measured_m / RANGE_SCALE_M))
    first, second = channels
    count = ((16 + memory) * first * 9 + first + (first + second) * second * 9 + 2 * second +
             first * second * 4 + first + first * (80 + memory) + 80 + memory)
    parameters = Parameters(generator, count * (1 if shared else LAYERS) + LAYERS)
    penalty = torch.exp(parameters.flat[-LAYERS:])
    mask = measured_mask()
    z, y = [linear], linear
    remembered = torch.zeros(1, memory, ROWS // 4, COLUMNS // 4, dtype=torch.float64)
    extra = {}
    for layer in range(LAYERS):
        b = penalty[layer]
        h = (mask * below + b * (z[-1] + y)) / (mask + 2.0 * b)
        if shared:
            parameters.next = 0
        next_z, remembered = u_shaped(parameters, channels, memory, slope, h, remembered, above,
                                      below)
        rejected = rejected_pixels(h.detach().numpy(), numpy.radians(10.0), min_pixels)
        y = torch.where(torch.tensor(rejected), next_z, h)
        z.append(next_z)
        if min_pixels > 0:
            extra[f"layers.{layer}.rejected"] = rejected.astype("|u1")
            assert 0.03 < rejected.mean() < 0.7, f"a dull mask: {rejected.mean()}"
    assert parameters.next == len(parameters.flat) - LAYERS
    save_network(name, measured_m, truth, parameters, z[1:], extra)


def simple_du(name, seed, features, convolutions):
    import torch

    generator = numpy.random.RandomState(seed)
    measured_m = scene_m()[FIRST_ROW::ROW_STRIDE]
    truth = torch.tensor(scene_m() / RANGE_SCALE_M)
    _, l, _ = start_images(torch.tensor(measured_m / RANGE_SCALE_M))
    channels = [1] + [features] * (convolutions - 1) + [1]
    parameters = Parameters(generator, sum(a * b * 9 for a, b in zip(channels, channels[1:])) + 1)
    parameters.stored[-1] = 96
    with torch.no_grad():
        parameters.flat[-1] = 96 / 256.0
    alpha = parameters.flat[-1]
    mask = measured_mask()
    z = [torch.zeros(ROWS, COLUMNS, dtype=torch.float64)]
    for _ in range(LAYERS):
        parameters.next = 0
        x = ((mask * alpha * l + z[-1]) / (mask * alpha + 1.0))[None, None]
        for i, (inputs, outputs) in enumerate(zip(channels, channels[1:])):
            x = conv2d(x, parameters.take(outputs, inputs, 3, 3), None, 1, (1, 1), False)
            x = torch.relu(x) if i + 1 < convolutions else x
        z.append(x[0, 0])
    save_network(name, measured_m, truth, parameters, z[1:], {})


def du_mix(name, seed, layers, memory, slope, layer_share):
    """Two modes per pixel (nn/hqs/two_modes.h). layers: channels, lower channels and residual blocks
    of each. Everything in the logarithm of ranges in metres."""
    import torch
    from torch.nn import functional

    generator = numpy.random.RandomState(seed)
    measured_m = scene_m()[FIRST_ROW::ROW_STRIDE].copy()
    measured_m[2, 30:33] = 0.0
    valid = torch.tensor((measured_m > 0.0).astype("<f8"))
    filled = measured_m.copy()
    for row in range(len(filled)):
        above = filled[row - 1] if row > 0 else numpy.full(COLUMNS, 20.0)
        filled[row] = numpy.where(filled[row] > 0.0, filled[row], above)
    filled = torch.tensor(filled)
    tile_rows = torch.arange(ROWS // 4)
    up, same, down = (tile_rows - 1).clamp(min=0), tile_rows, tile_rows

    def computed(of_tile):
        """[3, tile rows, columns]: the same for the three computed rows of a tile."""
        return of_tile[None].expand(3, -1, -1)

    above_m, below_m = computed(filled[up]), computed(filled[down])
    part = torch.tensor([0.25, 0.5, 0.75], dtype=torch.float64)[:, None, None]
    part = part.expand(3, ROWS // 4, COLUMNS).clone()
    start = -torch.log((1.0 - part) / above_m + part / below_m)
    above, below = above_m.log(), below_m.log()
    truth_m = torch.tensor(scene_m()).reshape(ROWS // 4, 4, COLUMNS).transpose(0, 1)[:3]
    there = (truth_m > 0.0).double()
    truth = torch.where(truth_m > 0.0, truth_m, torch.ones_like(truth_m)).log()

    def tiles(rows):
        """[rows of a tile, tile rows, columns] -> [1, rows x 4, tile rows, tile columns]."""
        n = rows.shape[0]
        return rows.reshape(n, ROWS // 4, COLUMNS // 4, 4).permute(0, 3, 1, 2).reshape(
            1, 4 * n, ROWS // 4, COLUMNS // 4)

    def untiled(x):
        n = x.shape[1] // 4
        return x.reshape(n, 4, ROWS // 4, COLUMNS // 4).permute(0, 2, 3, 1).reshape(
            n, ROWS // 4, COLUMNS)

    inputs = [16 + 8 + (15 - 3 + memory if layer else 0) for layer in range(len(layers))]
    outputs = [84 + (memory if layer + 1 < len(layers) else 0) for layer in range(len(layers))]
    count = sum(i * c * 9 + c + c * (ROWS // 4) + c * l * 9 + l + (1 + n) * (l * l * 9 + l) +
                l * c * 4 + c + c * o + o for i, o, (c, l, n) in zip(inputs, outputs, layers))
    parameters = Parameters(generator, count)
    middle, probability, remembered, loss = start, None, None, 0.0
    results = {}
    typical = numpy.log(20.0)
    for layer, (channels, lower, blocks) in enumerate(layers):
        h = torch.cat([middle, filled[None, same].log()])
        x = [tiles(0.5 * (h - typical)), tiles(valid[None] - 0.5),
             tiles((filled[up].log() - filled.log()).clamp(-1.0, 1.0)[None])]
        if layer:
            x += [tiles(probability - 0.5), remembered]
        x = torch.cat(x, 1)

        def activated(v):
            return torch.maximum(v, slope * v)

        weight, bias = parameters.take(channels, x.shape[1], 3, 3), parameters.take(channels)
        row_bias = parameters.take(channels, ROWS // 4)
        encoded = activated(conv2d(x, weight, bias, 1, (1, 1), True) + row_bias[None, :, :, None])
        weight, bias = parameters.take(lower, channels, 3, 3), parameters.take(lower)
        x = activated(conv2d(encoded, weight, bias, 2, (1, 1), True))
        for block in range(1 + blocks):
            weight, bias = parameters.take(lower, lower, 3, 3), parameters.take(lower)
            y = conv2d(x, weight, bias, 1, (1, 1), True)
            x = activated(y + x) if block else activated(y)
        weight, bias = parameters.take(lower, channels, 2, 2), parameters.take(channels)
        x = activated(functional.conv_transpose2d(x, weight, bias, 2) + encoded)
        weight, bias = parameters.take(outputs[layer], channels, 1, 1), parameters.take(outputs[layer])
        x = functional.conv2d(x, weight, bias)
        o = [untiled(x[:, 12 * g : 12 * (g + 1)]) for g in range(7)]
        remembered = x[:, 84:]
        share1, share2 = torch.sigmoid(4 * o[0]), torch.sigmoid(4 * o[2])
        mode1 = share1 * above + (1.0 - share1) * middle + o[1]
        mode2 = share2 * below + (1.0 - share2) * middle + o[3]
        weight1 = torch.sigmoid(4 * o[4])
        log_scale = -3.5 + 4.0 * o[5].clamp(-0.5, 1.0)
        probability = torch.sigmoid(4 * o[6])
        scale = log_scale.exp()
        density = (weight1 * torch.exp(-(truth - mode1).abs() / scale) +
                   (1.0 - weight1) * torch.exp(-(truth - mode2).abs() / scale)) / scale
        pixel = -0.3 * there * density.log() - there * probability.log()
        pixel = pixel - (1.0 - there) * (1.0 - probability).log()
        of_layer = pixel.mean()
        first = weight1 >= 0.5
        middle = torch.where(first, mode1, mode2)
        loss = loss + (1.0 if layer + 1 == len(layers) else layer_share) * of_layer
        range_m = middle.exp()
        tolerance = 0.5

        def below_scales(v):
            tail = 0.5 * torch.exp(-v.abs())
            return torch.where(v > 0, 1.0 - tail, tail)

        farther = torch.log(1.0 + tolerance / range_m) / scale
        nearer = -torch.log((1.0 - tolerance / range_m).clamp(min=1e-6)) / scale
        gap = (torch.where(first, mode2, mode1) - middle) / scale
        of_chosen = below_scales(farther) - below_scales(-nearer)
        of_other = below_scales(farther - gap) - below_scales(-nearer - gap)
        chosen = torch.where(first, weight1, 1.0 - weight1)
        results["range_m"] = range_m
        results["confidence"] = probability * (chosen * of_chosen + (1.0 - chosen) * of_other)
    assert parameters.next == len(parameters.flat)
    loss.backward()
    save(name, {"measured_m": measured_m, "parameters": parameters.stored,
                "loss": of_layer.reshape(1), "d_parameters": parameters.flat.grad, **results})


def make_networks():
    du_or("du_or", 10, (6, 8), 3, 0.0, shared=False, min_pixels=0)
    du_or("du_or_filtered", 11, (6, 8), 3, 0.125, shared=True, min_pixels=30)
    simple_du("simple_du", 12, 8, 5)
    du_mix("du_mix", 13, [(6, 8, 1)], 0, 0.125, 0.1)
    du_mix("du_mix_two_layers", 14, [(6, 8, 1), (5, 7, 0)], 3, 0.125, 0.25)


SECTIONS = {
    "npz": make_npz,
    "convolutions": make_convolutions,
    "layers": make_layers,
    "adamw": make_adamw,
    "networks": make_networks,
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
