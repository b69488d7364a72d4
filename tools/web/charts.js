'use strict';
// Charts as SVG: lines and layers over one axis, histograms, bars, intervals, and maps from above.
// Each has axes with units and shows below it the values under the pointer.

/** Steps of 1, 2 or 5 times a power of ten: about `wanted` multiples between two values in any order. */
function ticksBetween(from, to, wanted) {
  const [low, high] = [Math.min(from, to), Math.max(from, to)];
  const rough = Math.max(high - low, 1e-12) / wanted, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(factor => factor * power >= rough * .6);  // two ticks at least
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i <= high / step + 1e-9; ++i) ticks.push(i * step);
  return ticks;
}
const tickText = value => String(Number(value.toPrecision(6)));

/** The least and the greatest of numbers, of those that are finite. */
function extentOf(...lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists)
    for (const value of list) {
      if (Number.isFinite(value)) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
  return low <= high ? [low, high] : [0, 1];
}

/**
 * A plot with axes, drawn anew for each width that the page gives it.
 * spec: {x, y: {label, low, high, names: [[value, text], ...] instead of numbers}, x.whole: ticks
 * are whole numbers, height: pixels or a function of the width, left: room for the names}
 * draw(plot): adds to plot.svg by plot.toX and plot.toY. read(x, y, plot): returns what the readout
 * shows for a place of the plot, a list of texts, of which the first is bold.
 */
function plotFigure(spec, draw, read, entries = []) {
  const svg = el('svg', {role: 'img', 'aria-label': `${spec.y.label} over ${spec.x.label}`});
  const readout = el('div', {class: 'readout'}, hint(spec.hint));
  const figure =
      el('figure', {class: 'chart'}, entries.length > 1 ? legend(entries) : null, svg, readout);
  let plot = null;
  function redraw() {
    const width = Math.max(200, svg.clientWidth || figure.clientWidth || 600), left = spec.left ? spec.left(width) : 52;
    const right = 10, top = 20, bottom = 38;
    const height = Math.round(
        typeof spec.height === 'function' ? spec.height(width - left - right) + top + bottom : spec.height || 240);
    const {x, y} = spec, [w, h] = [width - left - right, height - top - bottom];
    plot = {
      svg,
      width: w,
      height: h,
      left,
      top,
      toX: value => left + w * (value - x.low) / (x.high - x.low),
      toY: value => top + h * (y.high - value) / (y.high - y.low),
      fromX: px => x.low + (px - left) / w * (x.high - x.low),
      fromY: px => y.high - (px - top) / h * (y.high - y.low)
    };
    svg.replaceChildren();
    svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    svg.style.height = height + 'px';
    if (spec.before) spec.before(plot);
    for (const value of ticksBetween(x.low, x.high, x.whole ? Math.min(w / 90, x.high - x.low) : w / 90)) {
      const px = plot.toX(value);
      svg.append(
          el('line', {class: 'grid', x1: px, x2: px, y1: top, y2: top + h}),
          el('text', {x: px, y: top + h + 15, 'text-anchor': 'middle'}, tickText(value)));
    }
    for (const [value, text] of y.names || ticksBetween(y.low, y.high, h / 45).map(v => [v, tickText(v)])) {
      const py = plot.toY(value);
      if (!y.names) svg.append(el('line', {class: 'grid', x1: left, x2: left + w, y1: py, y2: py}));
      svg.append(el('text', {x: left - 6, y: py + 4, 'text-anchor': 'end', class: y.names ? 'name' : undefined}, text));
    }
    svg.append(
        el('path', {class: 'axis', d: `M${left},${top}V${top + h}H${left + w}`}),
        el('text', {x: left + w, y: top + h + 31, 'text-anchor': 'end'}, spec.x.label));
    if (spec.y.label) svg.append(el('text', {x: spec.y.names ? 0 : Math.min(left, 4), y: 12}, spec.y.label));
    draw(plot);
    plot.pointer = el('g');
    svg.append(plot.pointer);
  }
  svg.onpointermove = svg.onpointerdown = event => {
    const box = svg.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left, event.clientY - box.top];
    plot.pointer.replaceChildren();
    const texts = read(plot.fromX(px), plot.fromY(py), plot);
    if (texts) readout.replaceChildren(el('b', {}, texts[0]), '  ' + texts.slice(1).join('   '));
  };
  svg.onpointerleave = () => plot && plot.pointer.replaceChildren();
  // In the next frame: drawing changes the height, of which the observer must not be told meanwhile.
  const fit = () => {
    if (!plot || Math.abs(plot.width + plot.left + 10 - svg.clientWidth) > 1) redraw();
  };
  new ResizeObserver(() => requestAnimationFrame(fit)).observe(svg);
  return figure;
}

/** The index of the value nearest to x, of rising values. */
function nearestIndex(values, x) {
  let low = 0, high = values.length - 1;
  while (high - low > 1) {
    const middle = low + high >> 1;
    if (values[middle] < x) low = middle;
    else high = middle;
  }
  return high < 0 ? -1 : Math.abs(values[low] - x) <= Math.abs(values[high] - x) ? low : high;
}

/** A path through places; a value that is not a number is a gap. */
function pathThrough(plot, x, y) {
  let path = '', drawing = false;
  for (let i = 0; i < y.length; ++i) {
    if (!Number.isFinite(y[i])) {
      drawing = false;
      continue;
    }
    const alone = !drawing && !Number.isFinite(y[i + 1] ?? NaN);
    path += `${drawing ? 'L' : 'M'}${plot.toX(x[i]).toFixed(1)},${plot.toY(y[i]).toFixed(1)}${alone ? 'h.1' : ''}`;
    drawing = true;
  }
  return path;
}

/** Of more values than the plot has pixels: per pixel the least and the greatest, or their mean. */
function thinned(x, y, pixels, means) {
  const per = Math.ceil(y.length / pixels);
  if (per < 3) return [x, y];
  const tx = [], ty = [];
  for (let i = 0; i < y.length; i += per) {
    const part = Array.from(y.slice(i, i + per)), middle = x[Math.min(i + (per >> 1), x.length - 1)];
    if (means) {
      tx.push(middle);
      ty.push(part.reduce((sum, v) => sum + v, 0) / part.length);
      continue;
    }
    const [low, high] = part.some(Number.isFinite) ? extentOf(part) : [NaN, NaN];
    tx.push(middle, middle);
    ty.push(low, high);
  }
  return [tx, ty];
}

/**
 * Lines over one axis, or layers on top of one another.
 * spec: {x: {label, values: rising}, y: {label, decimals}, stacked, height, series: [{name, y,
 * colour, dash, low, high: a band around the line}]}
 */
function lineChart(spec) {
  const x = numbersOf(spec.x.values), stacked = spec.stacked;
  const series = spec.series.map((s, i) => ({
                                   ...s,
                                   y: numbersOf(s.y),
                                   colour: s.colour || colourOf(i),
                                   low: s.low && numbersOf(s.low),
                                   high: s.high && numbersOf(s.high)
                                 }));
  const tops = [];  // of layers: the sum of a layer and those below it
  if (stacked) series.forEach((s, k) => tops.push(Float64Array.from(s.y, (v, i) => v + (k ? tops[k - 1][i] : 0))));
  const [xLow, xHigh] = extentOf(x);
  const [yLow, yHigh] = extentOf([0], ...(stacked ? tops : series.flatMap(s => [s.y, s.low || [], s.high || []])));
  const box = {
    x: {...spec.x, low: xLow, high: xHigh > xLow ? xHigh : xLow + 1},
    y: {...spec.y, low: 1.06 * yLow, high: yHigh > yLow ? 1.06 * yHigh : yLow + 1},
    height: spec.height
  };
  const draw = plot => {
    const order = stacked ? series.map((_, k) => series.length - 1 - k) : series.map((_, k) => k);
    for (const k of order) {
      const s = series[k], colour = `stroke:${s.colour}`;
      if (s.low) {
        const back = [...s.high.keys()].filter(i => Number.isFinite(s.high[i])).reverse();
        const edge = back.map(i => `L${plot.toX(x[i])},${plot.toY(s.high[i])}`).join('');
        const under = pathThrough(plot, x, s.low);
        if (under) plot.svg.append(el('path', {d: under + edge + 'Z', style: `fill:${s.colour};fill-opacity:.2`}));
      }
      const [tx, ty] = thinned(x, stacked ? tops[k] : s.y, plot.width, stacked);
      const path = pathThrough(plot, tx, ty);
      if (stacked && tx.length) {
        const base = plot.toY(0);
        plot.svg.append(el('path', {d: `${path}V${base}H${plot.toX(tx[0])}Z`, style: `fill:${s.colour}`}));
      } else {
        plot.svg.append(
            el('path',
               {class: 'line', d: path, style: `${colour};stroke-width:${s.width || 2}`, 'stroke-dasharray': s.dash}));
      }
    }
  };
  const read = (at, _, plot) => {
    const i = nearestIndex(x, at);
    if (i < 0) return null;
    const px = plot.toX(x[i]);
    plot.pointer.append(el('line', {class: 'pointer', x1: px, x2: px, y1: plot.top, y2: plot.top + plot.height}));
    const valueText = v => spec.y.decimals === undefined ? short(v) : fixed(v, spec.y.decimals);
    return [
      `${spec.x.label}: ${spec.x.text ? spec.x.text(i) : short(x[i])}`,
      ...series.map(
          s => `${s.name}: ${valueText(s.y[i])}${
              s.low && Number.isFinite(s.low[i]) ? ` (${valueText(s.low[i])} to ${valueText(s.high[i])})` : ''}`)
    ];
  };
  return plotFigure(box, draw, read, series.map(s => [s.colour, s.name]));
}

/** How often values lie between two bounds: spec: {x: {label, unit}, values, bins, most}. */
function histogram(spec) {
  const values = Array.from(numbersOf(spec.values)).filter(Number.isFinite), bins = spec.bins || 40;
  const [low, greatest] = extentOf(values.length ? values : [0, 1]);
  const high = Math.max(low + 1e-9, Math.min(greatest, spec.most ?? Infinity));
  const counts = new Array(bins).fill(0);
  for (const value of values) ++counts[clamp(Math.floor((value - low) / (high - low) * bins), 0, bins - 1)];
  const edge = i => low + (high - low) * i / bins;
  const box = {
    x: {label: spec.x.label + (greatest > high ? ' (last bar: and more)' : ''), low, high},
    y: {label: spec.y || 'count', low: 0, high: 1.06 * Math.max(1, ...counts)},
    height: spec.height || 200
  };
  return plotFigure(
      box, plot => counts.forEach((count, i) => plot.svg.append(el('rect', {
        x: plot.toX(edge(i)) + .5,
        width: Math.max(.5, plot.toX(edge(i + 1)) - plot.toX(edge(i)) - 1),
        y: plot.toY(count),
        height: Math.max(0, plot.toY(0) - plot.toY(count)),
        style: `fill:${spec.colour || colourOf(0)}`
      }))),
      at => {
        const i = Math.floor((at - low) / (high - low) * bins);
        return i >= 0 && i < bins ?
            [
              `${short(edge(i))} to ${i === bins - 1 && greatest > high ? short(greatest) : short(edge(i + 1))} ${
                  spec.x.unit || ''}`,
              `${counts[i]} of ${values.length} (${(100 * counts[i] / Math.max(1, values.length)).toFixed(1)} %)`
            ] :
            null;
      });
}

/** A bar per row, below its name: [{name, value, text, colour}]. */
function bars(rows, label) {
  const most = Math.max(1e-12, ...rows.map(row => row.value));
  return plotFigure(
      {
        x: {label, low: 0, high: 1.04 * most},
        y: {label: '', low: 0, high: rows.length, names: []},
        height: 58 + 40 * rows.length,
        left: () => 10
      },
      plot => rows.forEach((row, i) => {
        const top = plot.toY(rows.length - i), width = Math.max(1, plot.toX(Math.max(0, row.value)) - plot.left);
        plot.svg.append(
            el('text', {x: plot.left + 4, y: top + 16, class: 'name'}, row.name),
            el('rect', {x: plot.left, y: top + 20, width, height: 16, style: `fill:${row.colour || colourOf(0)}`}));
      }),
      (_, y) => {
        const row = rows[Math.floor(rows.length - y)];
        return row ? [row.name, row.text] : null;
      });
}

/**
 * Per row a mean with its interval, and a dot for each of the values that it is the mean of.
 * rows: [{name, dots, mean, low, high}]; a line stands at `zero`.
 */
function intervals(rows, label, zero = 0) {
  // Wide enough for the intervals and for nine tenths of the dots: one that is far out, as of a
  // drive on which a method was lost, would press all else together.
  const far = quantile(rows.flatMap(row => row.dots).map(v => Math.abs(v - zero)), .9) || 0;
  const reach = 1.1 *
      Math.max(
          far,
          ...rows.flatMap(row => [row.low, row.high, row.mean])
              .filter(Number.isFinite)
              .map(v => Math.min(Math.abs(v - zero), 4 * far || Infinity)),
          1e-6);
  const box = {
    x: {label, low: zero - reach, high: zero + reach},
    left: width => Math.min(220, .4 * width),
    y: {label: '', low: 0, high: rows.length, names: rows.map((row, i) => [rows.length - i - .5, row.name])},
    height: 60 + 34 * rows.length
  };
  return plotFigure(
      box,
      plot => {
        const inside = value => plot.toX(clamp(value, zero - reach, zero + reach));
        plot.svg.append(el('line', {
          x1: plot.toX(zero),
          x2: plot.toX(zero),
          y1: plot.top,
          y2: plot.top + plot.height,
          style: 'stroke:var(--text);stroke-width:1.5'
        }));
        rows.forEach((row, i) => {
          const y = plot.toY(rows.length - i - .5);
          for (const value of row.dots.filter(Number.isFinite))
            plot.svg.append(el('circle', {cx: inside(value), cy: y, r: 3.5, style: 'fill:var(--quiet);opacity:.5'}));
          if (Number.isFinite(row.low))
            plot.svg.append(el(
                'line',
                {x1: inside(row.low), x2: inside(row.high), y1: y, y2: y, style: 'stroke:var(--c0);stroke-width:4'}));
          if (Number.isFinite(row.mean))
            plot.svg.append(el('circle', {cx: inside(row.mean), cy: y, r: 6, style: 'fill:var(--c0)'}));
        });
      },
      (_, y) => {
        const row = rows[Math.floor(rows.length - y)];
        return row ?
            [
              row.name, `mean ${short(row.mean)}`, `95 % interval ${short(row.low)} to ${short(row.high)}`,
              `${row.dots.length} drives`
            ] :
            null;
      });
}

// Errors from none to the largest: the palette of images.js, from its violet on.
const kErrorStops = ['#3b0f70', '#8c2981', '#de4968', '#fe9f6d', '#fde26f'];

/**
 * A map from above with one scale for x and y, metres.
 * spec: {paths: [{name, x, y, colour, dash, values: per point, of which the colour tells, top: the
 * value of the last colour, gap: per point, whether nothing is known of the way to the next}],
 * points: [xs, ys] drawn faintly behind, marks: [{x, y, name}], label: (path, i) => texts}
 */
function mapFigure(spec) {
  const paths = spec.paths.map((p, i) => ({
                                 ...p,
                                 x: numbersOf(p.x),
                                 y: numbersOf(p.y),
                                 values: p.values && numbersOf(p.values),
                                 colour: p.colour || colourOf(i)
                               }));
  const [x0, x1] = extentOf([0], ...paths.map(p => p.x)), [y0, y1] = extentOf([0], ...paths.map(p => p.y));
  const margin = spec.margin ?? Math.max(12, .06 * Math.max(x1 - x0, y1 - y0));
  let [w, h] = [x1 - x0 + 2 * margin, y1 - y0 + 2 * margin];
  w = Math.max(w, h / 1.1);
  h = Math.max(h, w / 2.4);  // neither a strip nor a tower
  const box = {
    x: {label: 'x, m', low: (x0 + x1 - w) / 2, high: (x0 + x1 + w) / 2},
    y: {label: 'y, m', low: (y0 + y1 - h) / 2, high: (y0 + y1 + h) / 2},
    height: width => width * h / w,
    hint: spec.hint
  };
  if (spec.points)
    box.before = plot => plot.svg.append(el('image', {
      href: densityPicture(spec.points, box),
      x: plot.left,
      y: plot.top,
      width: plot.width,
      height: plot.height,
      preserveAspectRatio: 'none'
    }));
  // Below a path whose colours tell its errors a wider one in grey: some are near the page's colour.
  const drawn = paths.flatMap(p => p.values ? [{...p, values: null, colour: 'var(--c7)', width: p.width + 2}, p] : [p]);
  const draw = plot => {
    for (const p of drawn) {
      const colour = i => p.values ?
          (Number.isFinite(p.values[i]) ?
               `rgb(${colourBetween(kErrorStops, Math.round(20 * p.values[i] / (p.top || 1)) / 20)})` :
               'var(--quiet)') :
          p.colour;
      let [path, now] = ['', null];
      const end = () => {
        const style = `stroke:${now};stroke-width:${p.width || 2.5}`;
        if (path) plot.svg.append(el('path', {class: 'line', d: path, style, 'stroke-dasharray': p.dash}));
        path = '';
      };
      const place = i => `${plot.toX(p.x[i]).toFixed(1)},${plot.toY(p.y[i]).toFixed(1)}`;
      for (let i = 0; i + 1 < p.x.length; ++i) {
        if (p.gap && p.gap[i]) {
          end();
          continue;
        }
        if (!path || colour(i + 1) !== now) {
          end();
          now = colour(i + 1);
          path = 'M' + place(i);
        }
        path += 'L' + place(i + 1);
      }
      end();
    }
    for (const mark of spec.marks || []) {
      const [px, py] = [plot.toX(mark.x), plot.toY(mark.y)];
      plot.svg.append(
          el('circle', {cx: px, cy: py, r: 5, style: 'fill:var(--page);stroke:var(--text);stroke-width:2.5'}),
          el('text', {x: px + 9, y: py + (mark.below ? 14 : -6), class: 'name'}, mark.name));
    }
  };
  const read = (x, y, plot) => {
    let [best, nearest] = [30 * w / plot.width, null];
    for (const p of paths)
      for (let i = 0; i < p.x.length; ++i) {
        const away = Math.hypot(p.x[i] - x, p.y[i] - y);
        if (away < best) {
          best = away;
          nearest = [p, i];
        }
      }
    if (!nearest) return [`x ${x.toFixed(1)} m, y ${y.toFixed(1)} m`];
    const [p, i] = nearest;
    plot.pointer.append(
        el('circle', {cx: plot.toX(p.x[i]), cy: plot.toY(p.y[i]), r: 6, class: 'pointer', fill: 'none'}));
    return [
      p.name, ...(p.label ? p.label(i) : []), `x ${p.x[i].toFixed(2)} m, y ${p.y[i].toFixed(2)} m`,
      ...(p.values && Number.isFinite(p.values[i]) ? [`error ${short(p.values[i])} m`] : [])
    ];
  };
  return plotFigure(box, draw, read);
}

/** Points from above as a picture: the more lie over a pixel, the stronger its grey. */
function densityPicture([xs, ys], {x, y}) {
  const columns = Math.round(clamp((x.high - x.low) / .2, 200, 900)),
        rows = Math.max(1, Math.round(columns * (y.high - y.low) / (x.high - x.low)));
  const counts = new Uint32Array(rows * columns);
  for (let i = 0; i < xs.length; ++i) {
    const column = Math.floor((xs[i] - x.low) / (x.high - x.low) * columns),
          row = Math.floor((y.high - ys[i]) / (y.high - y.low) * rows);
    if (column >= 0 && column < columns && row >= 0 && row < rows) ++counts[row * columns + column];
  }
  const full = Math.log(Math.max(2, quantile(counts.filter(count => count > 0), .99) || 2));
  const picture = el('canvas', {width: columns, height: rows}), context = picture.getContext('2d'),
        image = context.createImageData(columns, rows);
  counts.forEach((count, i) => {
    image.data.set([127, 127, 127, count ? 25 + 200 * Math.min(1, Math.log(count) / full) : 0], 4 * i);
  });
  context.putImageData(image, 0, 0);
  return picture.toDataURL();
}

/** What the colours of a path's errors mean. */
const errorScale = (top, clipped) =>
    el('div', {class: 'scale'}, 'error 0', el('i', {style: `background:linear-gradient(90deg,${kErrorStops})`}),
       `${short(top)} m${clipped ? ' or more' : ''}`);
