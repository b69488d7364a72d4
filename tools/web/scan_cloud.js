'use strict';
// One range image as a cloud of points that turns: drag or arrow keys turn, wheel or two buttons zoom.

/**
 * A view of rows x columns ranges in metres. spec: {elevation_deg: of each row, columns, height: css}
 * The figure has show(ranges_m, rgba), which draws the pixels with a return in their colours: four
 * bytes for each (Uint8ClampedArray), as in the picture of the image.
 */
function scanCloud(spec) {
  const kNear_m = 0.5, kLens = 1.1;  // metres before the eye; distance of the picture, in its widths
  const canvas = el('canvas', {'aria-label': 'Points in three dimensions', style: `height:${spec.height};width:100%;cursor:grab;touch-action:none;display:block;background:#11141c;border-radius:6px`});
  const zoom = factor => () => { eye.distance_m = clamp(eye.distance_m * factor, 5, 200); draw(); };
  const figure = el('figure', {}, canvas, el('figcaption', {class: 'controls'}, 'The same ranges as points; drag or arrow keys turn them.',
      el('button', {onclick: zoom(.8)}, 'Nearer'), el('button', {onclick: zoom(1.25)}, 'Farther')));
  const eye = {yaw: 2.6, pitch: .45, distance_m: 0};
  const rows = spec.elevation_deg.length, columns = spec.columns;
  const azimuths = Array.from({length: columns}, (_, x) => Math.PI - 2 * Math.PI * (x + .5) / columns);
  const elevations = spec.elevation_deg.map(degrees => degrees * Math.PI / 180);
  let ranges = null, pixels = null;

  /** Each point in front of the eye onto its pixel, the nearest one on top. */
  function draw() {
    if (!ranges || !canvas.clientWidth) return;
    const width = canvas.width = canvas.clientWidth, height = canvas.height = canvas.clientHeight;
    const context = canvas.getContext('2d'), image = context.createImageData(width, height);
    const depth = new Float32Array(width * height).fill(Infinity), to = new Uint32Array(image.data.buffer);
    const from = new Uint32Array(pixels.buffer);
    to.fill(0xff1c1411);
    const [cy, sy, cp, sp] = [Math.cos(eye.yaw), Math.sin(eye.yaw), Math.cos(eye.pitch), Math.sin(eye.pitch)];
    for (let i = 0; i < rows * columns; ++i) {
      const range_m = ranges[i];
      if (!(range_m > 0)) continue;
      const elevation = elevations[i / columns | 0], azimuth = azimuths[i % columns], flat = range_m * Math.cos(elevation);
      const x = flat * Math.cos(azimuth), y = flat * Math.sin(azimuth), z = range_m * Math.sin(elevation);
      const ahead = x * cy + y * sy, right = x * sy - y * cy;
      const away = eye.distance_m + ahead * cp - z * sp, up = ahead * sp + z * cp;
      if (away < kNear_m) continue;
      const u = width / 2 + kLens * width * right / away | 0, v = height / 2 - kLens * width * up / away | 0;
      const size = clamp(60 / away | 0, 1, 3);
      for (let dv = 0; dv < size; ++dv)
        for (let du = 0; du < size; ++du) {
          const at = (v + dv) * width + u + du;
          if (u < 0 || u + du >= width || v < 0 || v + dv >= height || depth[at] <= away) continue;
          depth[at] = away;
          to[at] = from[i];
        }
    }
    context.putImageData(image, 0, 0);
  }

  canvas.onpointerdown = event => canvas.setPointerCapture(event.pointerId);
  const turn = (yaw, pitch) => { eye.yaw += yaw; eye.pitch = clamp(eye.pitch + pitch, -.3, 1.5); draw(); };
  canvas.onpointermove = event => event.buttons && turn(-.008 * event.movementX, .006 * event.movementY);
  onArrowKeys(canvas, (right, down) => turn(-.06 * right, -.06 * down));
  canvas.onwheel = event => {  // only once it was clicked on: before, the page scrolls
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    zoom(event.deltaY > 0 ? 1.1 : .9)();
  };
  new ResizeObserver(draw).observe(canvas);
  figure.show = (ranges_m, rgba) => {
    ranges = ranges_m;
    pixels = rgba;
    if (!eye.distance_m) eye.distance_m = clamp(3 * quantile(ranges.filter(range_m => range_m > 0), .5) || 40, 5, 60);
    draw();
  };
  return figure;
}
