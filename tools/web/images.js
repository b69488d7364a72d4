'use strict';
// Range images, tensors and classes of pixels, with a colour scale and the value under the pointer.

// Colours from low to high, rising in lightness, so that they differ in grey, too (after
// viridis, magma and cividis of matplotlib).
const kViridis = ['#440154', '#414487', '#2a788e', '#22a884', '#7ad151', '#fde725'];
const kMagma = ['#000004', '#3b0f70', '#8c2981', '#de4968', '#fe9f6d', '#fcfdbf'];
const kGreys = ['#000000', '#ffffff'];

/** 256 colours of a palette as bytes. */
function table256(stops) { return Array.from({length: 256}, (_, i) => colourBetween(stops, i / 255)); }

// No return: a grey that no colour of a range comes near, on projectors, too.
const kNone = '#7b818b';

/**
 * How values become colours: {name, stops, share: value => 0 to 1, ends: [text, text], ticks: values
 * that are written below the colours}.
 * Ranges: near is bright, logarithmic, no return is grey.
 */
function rangeScale(most_m) {
  return {
    name: 'range',
    stops: [...kViridis].reverse(),
    none: value => !(value > 0),
    ends: ['1 m', `${short(most_m)} m`],
    ticks: [2, 5, 10, 20, 50, 100].filter(range_m => range_m < most_m),
    share: value => Math.log(Math.max(value, 1)) / Math.log(most_m)
  };
}
const errorScaleOfImages = {
  name: 'error',
  stops: kMagma,
  ends: ['0.01 m', '10 m and more'],
  share: value => (2 + Math.log10(Math.max(value, 1e-3))) / 3
};
const shareScale = {
  name: 'share',
  stops: kGreys,
  ends: ['0', '1'],
  share: value => value
};
function linearScale(low, high) {
  return {
    name: 'value',
    stops: kViridis,
    ends: [short(low), short(high)],
    share: value => (value - low) / Math.max(high - low, 1e-12)
  };
}
/** Classes: [[colour, name], ...] by the value of the pixel. */
const classScale = classes => ({name: 'class', classes});

/** The colour bar or the list of classes of a scale. */
function scaleLegend(scale) {
  if (scale.classes) return legend(scale.classes.map(([colour, name]) => [colour, name]));
  const ticks = (scale.ticks || []).map(value => el('span', {style: `left:${100 * scale.share(value)}%`}, String(value)));
  return el(
      'div', {class: 'scale'}, scale.ends[0],
      el('i', {style: `background:linear-gradient(90deg,${scale.stops})`, class: ticks.length && 'ticked'}, ...ticks), scale.ends[1],
      ...(scale.none ? [el('span', {class: 'none'}, el('i', {style: `background:${kNone}`}), 'no return')] : []));
}

/**
 * An image of rows x columns values.
 * spec: {rows, columns, values, scale, unit, height: css, label: (row, column, value) => texts, axes:
 * whether to write the azimuth below, elevation_deg: of the rows, every: it has every n-th column, marks: [{row, column, colour}] drawn
 * over it}
 * The figure has show({values, scale, unit}), which replaces what is seen, pixels(), the colours that
 * are seen, ring(row, column), which puts a ring round a pixel (round none for a row below 0), and
 * onpick(row, column), called for the pixel under the pointer.
 */
function imageFigure(spec) {
  const {rows, columns} = spec;
  const canvas = el('canvas', {'aria-label': spec.caption || 'Image', width: columns, height: rows, style: `height:${spec.height || '8rem'}`});
  const readout = el('div', {class: 'readout'}, hint(spec.hint));
  const key = el('div');
  const caption = el('figcaption', {}, spec.caption || '');
  const axes = spec.axes === false ?
      null :
      el('div', {class: 'axes'},
         ...['behind (+180°)', 'left (+90°)', 'ahead (0°)', 'right (-90°)', 'behind (-180°)'].map(
             text => el('span', {}, text)));
  const elevations = (spec.elevation_deg || []).filter((_, row) => row === 0 || row === rows - 1)
                         .map((degrees, i) => el('span', {class: i ? 'lowest' : 'highest'}, `elevation ${degrees.toFixed(1)}°`));
  const ring = el('i', {class: 'ring', hidden: true});
  const figure = el('figure', {}, caption, el('div', {class: 'image'}, el('div', {class: 'pixels'}, canvas, ring, ...elevations), axes), key, readout);
  let shown = {};
  figure.show = what => {
    shown = {...shown, ...what};
    if (what.caption !== undefined) caption.textContent = what.caption;
    const {values, scale} = shown, context = canvas.getContext('2d'), image = context.createImageData(columns, rows);
    const colours =
        scale.classes ? scale.classes.map(([colour]) => colourBetween([colour, colour], 0)) : table256(scale.stops);
    for (let i = 0; i < rows * columns; ++i) {
      const value = values[i];
      const colour = scale.classes        ? colours[value] :
          scale.none && scale.none(value) ? colourBetween([kNone, kNone], 0) :
                                            colours[clamp(Math.round(255 * scale.share(value)), 0, 255)];
      image.data.set(colour || [0, 0, 0], 4 * i);
      image.data[4 * i + 3] = 255;
    }
    if (shown.shade)
      for (let i = 0; i < rows * columns; ++i)
        for (let k = 0; k < 3; ++k) image.data[4 * i + k] *= shown.shade(i);
    for (const mark of shown.marks || [])
      image.data.set(colourBetween([mark.colour, mark.colour], 0), 4 * (mark.row * columns + mark.column));
    context.putImageData(image, 0, 0);
    figure.pixels = () => image.data;
    key.replaceChildren(scaleLegend(scale));
  };
  let ringed = [rows >> 1, columns >> 1];  // from here the arrow keys go
  figure.ring = (row, column) => {
    ringed = [row, column];
    ring.hidden = row < 0;
    ring.style.left = `${100 * (column + .5) / columns}%`;
    ring.style.top = `${100 * (row + .5) / rows}%`;
  };
  figure.read = (row, column) => {
    const value = shown.values[row * columns + column], {scale, unit} = shown;
    const valueText = scale.classes            ? (scale.classes[value] || ['', '?'])[1] :
        scale.name === 'range' && !(value > 0) ? 'no return' :
                                                 `${short(value)} ${unit || ''}`;
    const {every = 1} = spec, azimuth = 180 - 360 * (every * column + .5) / (every * columns);
    readout.replaceChildren(
        el('b', {}, valueText),
        `  row ${row}, column ${every * column}${spec.axes === false ? '' : `, azimuth ${azimuth.toFixed(1)}°`}`,
        ...(spec.label ? ['  ' + spec.label(row, column)] : []));
  };
  function pick(row, column) {
    figure.read(row, column);
    if (figure.onpick) figure.onpick(row, column);
  }
  canvas.onpointermove = canvas.onpointerdown = event => {
    const box = canvas.getBoundingClientRect();
    const row = clamp(Math.floor((event.clientY - box.top) / box.height * rows), 0, rows - 1);
    const column = clamp(Math.floor((event.clientX - box.left) / box.width * columns), 0, columns - 1);
    pick(row, column);
  };
  onArrowKeys(canvas, (right, down) => {
    figure.ring(clamp(ringed[0] + down, 0, rows - 1), clamp(ringed[1] + right, 0, columns - 1));
    pick(...ringed);
  });
  if (spec.values)
    figure.show({values: spec.values, scale: spec.scale, unit: spec.unit, marks: spec.marks, shade: spec.shade});
  return figure;
}

/** An occupancy grid from above (turning_view.h), with where the pointer is. */
function gridFigure(grid) {
  const {rows, columns, cell_m, origin_m} = grid;
  return imageFigure({rows, columns, values: cellsOf(grid), axes: false, height: 'auto', caption: grid.summary,
    scale: classScale([['#808890', 'unknown'], ['#f4f4f4', 'free'], ['#101418', 'occupied']]),
    label: (row, column) => `x ${(origin_m[0] + (column + .5) * cell_m).toFixed(1)} m, y ${(origin_m[1] + (rows - row - .5) * cell_m).toFixed(1)} m`});
}
