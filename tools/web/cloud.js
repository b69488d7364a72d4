'use strict';
// A cloud of points that is turned, moved and zoomed with mouse, fingers or keys, with an occupancy
// grid below it, and paths and single scans over it. It needs WebGL 2.
//
// A picture is made in three passes: the grid and the points are drawn into memory, with the depth
// of every pixel; that picture goes onto the canvas, darkened beside what is nearer, so that edges
// are seen; the paths, the sensor and a measured distance are drawn over it. Places are in metres
// from the camera's target, so that numbers stay small wherever the map is.

const rgb = hex => [16, 8, 0].map(bits => (parseInt(hex, 16) >> bits & 255) / 255);
const kHeights = ['3a4c96', '2a8498', '56b276', 'd6c85c', 'f6ecce'].map(rgb);
const kConfidence = ['c0392b', 'e67e22', 'e8d36b', '7fc8a9', '4aa3df'].map(rgb);
const kBrightness = ['262a52', '6a3d8f', 'c34f72', 'f28f4e', 'fbe9a8'].map(rgb);
const kPalettes = [kHeights, kConfidence, kBrightness];
const kMeasured = rgb('ffd24a'), kUpsampled = rgb('35c3f3');
const kLoops = rgb('d58cff'), kSensor = rgb('ffffff');
// One path alone is that of the sensor. Several have colours that people with any kind of colour
// blindness tell apart (Okabe and Ito, 2008), lighter for the dark ground.
const kPath = 'ff7a5c', kPaths = ['56b4e9', 'e69f00', '2fc79b', 'd994ba', 'f0e442', 'f07e35', '7c9cff', 'c8ccd4'];
const kBackground = rgb('11141c');

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const less = (a, b) => a.map((value, i) => value - b[i]);

/** The elements of a view: controls above, the canvas below. */
function turningStage(data) {
  const box = (name, colour, text) => el('label', {}, el('input', {type: 'checkbox', class: name, checked: true}),
                                         colour ? el('i', {style: `background:${colour};border-radius:50%`}) : null, text);
  const upsamples = Boolean(data.drive) && data.drive.rows.some(row => !row.measured);
  const hasScans = data.scans.length > 0, when = (condition, element) => { element.hidden = !condition; return element; };
  return el('figure', {class: 'turning-view'},
    el('div', {class: 'controls'},
      el('button', {'data-view': 'overview'}, 'Overview'), el('button', {'data-view': 'above'}, 'From above'),
      when(hasScans, el('button', {'data-view': 'behind'}, 'Behind the sensor')),
      when(data.clouds.length > 1, el('label', {}, 'Points ', el('select', {class: 'cloud'}))),
      el('label', {}, 'Colour ', el('select', {class: 'colour'}, ...['height', 'confidence', 'intensity'].map(name => el('option', {}, name)))),
      when(hasScans, box('map', '', 'map')), when(data.grid, box('grid', '', 'grid')),
      ...data.paths.map(path => when(path.pieces.length, box('path', '#' + path.colour, path.name))),
      when(data.loops.length, el('label', {}, el('i', {style: 'background:#d58cff;border-radius:50%'}), 'loops: places recognized again'))),
    when(hasScans, el('div', {class: 'controls scans'},
      el('button', {class: 'play'}, 'Play'), el('input', {type: 'range', class: 'scan', min: 0, value: 0, 'aria-label': 'Scan'}), el('output'),
      box('measured', '#ffd24a', 'measured'), when(upsamples, box('upsampled', '#35c3f3', 'upsampled')))),
    el('div', {class: 'stage'}, el('canvas', {tabindex: 0, 'aria-label': 'Points in three dimensions'}),
      el('div', {class: 'corner'}, el('button', {class: 'measure'}, 'Measure'), el('button', {class: 'full'}, 'Full screen')),
      el('output', {class: 'over distance', hidden: true}),
      el('div', {class: 'over metres'}, el('span'), el('i')),
      el('div', {class: 'over key'}, el('span', {class: 'low'}), el('i'), el('span', {class: 'high'}))),
    el('figcaption', {}, 'Drag to turn, Shift or right button to move, wheel to zoom (click first); two fingers move and zoom; arrow keys turn, + and - zoom.',
       data.grid ? ' Grid, at the height of the ground: light cells are free, black ones occupied, dark grey ones unknown.' : ''));
}

/**
 * Puts a view of data (C++: turning_view.h) into the element `into`. Returns its figure, of which
 * renew(data) shows other data with as many clouds from the same place, and sensorAt(pose) moves
 * the arrow of the first scan; null without WebGL 2. onscan(i) is called for each scan that is
 * shown, with -1 for none.
 */
function turningView(into, data, onscan = () => {}) {
  if (data.drive) data.scans = scansOf(data.drive);
  data.paths.forEach((path, i) => { path.colour = data.paths.length > 1 ? kPaths[i % kPaths.length] : kPath; });
  const root = turningStage(data), find = name => root.querySelector(name);
  const canvas = find('canvas');
  const gl = canvas.getContext('webgl2', {antialias: false, alpha: false});
  if (!gl) {
    into.append(el('p', {class: 'notice'}, 'The view that turns needs a browser with WebGL 2.'));
    return null;
  }
  into.append(root);

  function program(vertices, pixels) {
    const result = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertices], [gl.FRAGMENT_SHADER, pixels]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(result, shader);
    }
    for (const [place, name] of [[0, 'point'], [1, 'bright'], [0, 'from'], [1, 'to']]) gl.bindAttribLocation(result, place, name);
    gl.linkProgram(result);
    if (!gl.getProgramParameter(result, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(result));
    const at = {program: result};  // and where its uniforms are
    for (let i = gl.getProgramParameter(result, gl.ACTIVE_UNIFORMS); i-- > 0;) {
      const name = gl.getActiveUniform(result, i).name.replace('[0]', '');
      at[name] = gl.getUniformLocation(result, name);
    }
    return at;
  }
  const points = program(kPointVertices, kPointPixels);
  const shaded = program(kWholeCanvas, kShadedPixels);
  const floor = program(kGridVertices, kGridPixels);
  const depth = program(kWholeCanvas, kDepthPixels);
  const lines = program(kLineVertices, kLinePixels);

  function bufferOf(values) {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    return buffer;
  }
  // Pairs of places, by their distance from the middle of the scene.
  function linesOf(pairs) {
    return {count: pairs.length, buffer: bufferOf(new Float32Array(pairs.flatMap(
        ([from, to]) => [...less(from, data.centre), ...less(to, data.centre)])))};
  }
  let paths, loops;
  function takeLines() {
    paths = data.paths.map(path => linesOf(path.pieces.flatMap(piece => piece.slice(1).map((to, i) => [piece[i], to]))));
    loops = linesOf(data.loops);
  }
  takeLines();
  let sensor = linesOf([]), measured = linesOf([]);

  const texture = (kind, width, height) => {
    const made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texStorage2D(gl.TEXTURE_2D, 1, kind, width, height);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    return made;
  };
  let cells = null;
  if (data.grid && Math.max(data.grid.rows, data.grid.columns) <= gl.getParameter(gl.MAX_TEXTURE_SIZE)) {
    const {rows, columns} = data.grid;
    cells = texture(gl.R8UI, columns, rows);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, columns, rows, gl.RED_INTEGER, gl.UNSIGNED_BYTE, cellsOf(data.grid));
  }

  // The picture in memory, as large as the canvas.
  const memory = gl.createFramebuffer();
  let textures = [];
  function fitCanvas(sharpness) {
    const ratio = sharpness * Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (textures.length && canvas.width === width && canvas.height === height) return;
    canvas.width = width; canvas.height = height;
    textures.forEach(old => gl.deleteTexture(old));
    gl.bindFramebuffer(gl.FRAMEBUFFER, memory);
    textures = [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]].map(([kind, role]) => {
      const made = texture(kind, width, height);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, role, gl.TEXTURE_2D, made, 0);
      return made;
    });
  }

  // The camera looks at the target from a distance; yaw 0 looks along x, pitch is downwards.
  const wholeFrom = factor => factor * data.radius * Math.max(1, canvas.clientHeight / canvas.clientWidth || 1);
  const camera = {target: [...data.centre], distance: wholeFrom(2.4), yaw: 1.1, pitch: .62};
  let goal = null;  // where the camera glides to
  let shown = {cloud: 0, scan: 0, by: 0};
  // While the camera moves: how many pixels a voxel may be wide, and whether pixels are twice as
  // large; as 30 pictures a second need.
  let coarse = 2, blurred = false;

  function lens() {
    const {yaw, pitch, distance} = camera;
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    const ahead = [cp * cy, cp * sy, -sp], right = [sy, -cy, 0], up = [cy * sp, sy * sp, cp];
    const y = 2.2, x = y * canvas.height / canvas.width, near = clamp(distance / 100, .05, 5);
    const toClip = [0, 1, 2].flatMap(i => [x * right[i], y * up[i], ahead[i], ahead[i]]);
    toClip.push(0, 0, distance - 2 * near, distance);
    return {ahead, right, up, x, y, near, toClip, focal: y * canvas.height / 2};
  }

  // Draws the blocks within the picture, each with as many points as its distance needs.
  function drawCloud(cloud, look, colours) {
    if (!cloud.buffer) {
      cloud.buffer = bufferOf(typeof cloud.points === 'string' ? bytesOf(cloud.points) : cloud.points);
      cloud.shine = bufferOf(bytesOf(cloud.brightness || ''));
      delete cloud.points;
      delete cloud.brightness;
    }
    if (colours.by === 2) {
      gl.bindBuffer(gl.ARRAY_BUFFER, cloud.shine);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 1, gl.UNSIGNED_BYTE, true, 0, 0);
      gl.vertexAttribDivisor(1, 0);
    } else {
      gl.disableVertexAttribArray(1);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, cloud.buffer);
    gl.vertexAttribIPointer(0, 1, gl.UNSIGNED_INT, 0, 0);
    gl.uniform1f(points.step, cloud.step);
    gl.uniform1f(points.least, colours.least * canvas.height / canvas.clientHeight);
    gl.uniform1i(points.by, colours.by);
    gl.uniform3fv(points.palette, colours.palette.flatMap(stop => stop.map(part => part * colours.light)));
    const size = 512 * cloud.step, reach = .87 * size;
    const origin = less(cloud.origin, camera.target);
    let first = 0;
    for (const [x, y, z, ...ends] of cloud.blocks) {
      const corner = [origin[0] + x * size, origin[1] + y * size, origin[2] + z * size];
      const middle = corner.map(value => value + size / 2);
      const away = dot(look.ahead, middle) + camera.distance;
      const seen = away > -reach &&
          Math.abs(dot(look.right, middle)) * look.x < away + reach * Math.hypot(1, look.x) &&
          Math.abs(dot(look.up, middle)) * look.y < away + reach * Math.hypot(1, look.y);
      if (seen) {
        const voxel = look.coarse * Math.max(away - reach, look.near) / look.focal;  // metres
        const level = clamp(Math.floor(Math.log2(voxel / cloud.step)), 0, ends.length - 1);
        gl.uniform3fv(points.corner, corner);
        gl.uniform1f(points.side, look.focal * Math.max(colours.spacing, cloud.step * 2 ** level));
        gl.drawArrays(gl.POINTS, first, ends[level]);
      }
      first += ends[0];
    }
  }

  function drawLines(what, colour, width) {
    if (!what.count) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, what.buffer);
    for (const place of [0, 1]) gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 24, 12 * place);
    gl.uniform3fv(lines.colour, colour);
    gl.uniform1f(lines.width, width * canvas.height / canvas.clientHeight);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, what.count);
  }

  // At the height of the ground, as far as it is known: that of the lowest points.
  function drawGrid(look) {
    const {rows, columns, cell_m, origin_m} = data.grid;
    gl.useProgram(floor.program);
    gl.bindTexture(gl.TEXTURE_2D, cells);
    gl.uniformMatrix4fv(floor.toClip, false, look.toClip);
    gl.uniform3fv(floor.corner, less([...origin_m, data.heights[0]], camera.target));
    gl.uniform2f(floor.size, columns * cell_m, rows * cell_m);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  /** exactly: with the depths of all points as they are. */
  function draw(coarseness, sharpness, exactly = false) {
    fitCanvas(sharpness);
    const look = {...lens(), coarse: coarseness};
    gl.bindFramebuffer(gl.FRAMEBUFFER, memory);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...kBackground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    if (cells && find('.grid').checked) drawGrid(look);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribDivisor(0, 0);
    gl.useProgram(points.program);
    gl.uniformMatrix4fv(points.toClip, false, look.toClip);
    gl.uniform2fv(points.heights, data.heights.map(height => height - camera.target[2]));
    const scan = data.scans[shown.scan - 1];
    const palette = kPalettes[shown.by];
    if (data.clouds.length && find('.map').checked) {
      const cloud = data.clouds[shown.cloud];
      drawCloud(cloud, look, {palette, by: shown.by, light: scan ? .4 : paths.length > 1 ? .55 : 1, spacing: .8 * cloud.spacing, least: 1});
    }
    if (scan) {  // a little nearer than the map, which has the same surfaces
      const nearer = [...look.toClip];
      if (!exactly) nearer[14] -= .04 * look.near;
      gl.uniformMatrix4fv(points.toClip, false, nearer);
      for (const [kind, colour] of [['measured', kMeasured], ['upsampled', kUpsampled]]) {
        const plain = {palette: Array(5).fill(colour), by: 0, light: 1, spacing: .07, least: 2};
        if (scan[kind] && find('.' + kind).checked) drawCloud(scan[kind], look, plain);
      }
    }

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    gl.disableVertexAttribArray(0);
    gl.useProgram(shaded.program);
    textures.forEach((texture, i) => { gl.activeTexture(gl.TEXTURE0 + i); gl.bindTexture(gl.TEXTURE_2D, texture); });
    gl.uniform1i(shaded.colours, 0);
    gl.uniform1i(shaded.depths, 1);
    gl.uniform1i(shaded.reach, Math.max(1, Math.round(canvas.height / canvas.clientHeight)));
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.activeTexture(gl.TEXTURE0);

    gl.useProgram(lines.program);
    for (const place of [0, 1]) { gl.enableVertexAttribArray(place); gl.vertexAttribDivisor(place, 1); }
    gl.uniformMatrix4fv(lines.toClip, false, look.toClip);
    gl.uniform3fv(lines.shift, less(data.centre, camera.target));
    gl.uniform2f(lines.pixel, 2 / canvas.width, 2 / canvas.height);
    gl.uniform1f(lines.near, look.near);
    const boxes = root.querySelectorAll('.path');
    // Wider below: where several are in one place all are seen.
    paths.forEach((path, i) => { if (boxes[i].checked) drawLines(path, rgb(data.paths[i].colour), Math.min(3 + 2 * (paths.length - 1 - i), 9)); });
    if (boxes.length && boxes[0].checked) drawLines(loops, kLoops, 8);
    drawLines(sensor, kSensor, 3);
    drawLines(measured, kSensor, 2);
    for (const place of [0, 1]) gl.disableVertexAttribArray(place);
    showScale(look);
  }

  function showScale(look) {
    const pixelsPerMetre = look.focal / camera.distance * canvas.clientHeight / canvas.height;
    const metres = [.1, .2, .5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000].find(m => m * pixelsPerMetre > Math.min(60, canvas.clientWidth / 8)) || 5000;
    find('.metres i').style.width = metres * pixelsPerMetre + 'px';
    find('.metres span').textContent = metres + ' m';
  }

  // Pictures are drawn as long as something moves, then once with all points.
  let drawing = false, moved = false, movingUntil = 0, before = 0;
  function frame(now) {
    if (goal) glide();
    if (moved) movingUntil = now + 200;
    moved = false;
    const moving = now < movingUntil;
    if (moving && before) {
      coarse = clamp(coarse * clamp((now - before) / 30, .92, 1.25), 1, 8);
      if (coarse > 4 && !blurred) { blurred = true; coarse = 2; }
      if (coarse === 1) blurred = false;
    }
    before = now;
    if (moving) draw(coarse, blurred ? .5 : 1); else draw(1, 1);
    drawing = moving;
    if (moving) requestAnimationFrame(frame);
  }
  function redraw(moving = false) {
    moved = moved || moving;
    if (drawing) return;
    drawing = true;
    before = 0;
    requestAnimationFrame(frame);
  }
  function glide() {
    const turn = Math.atan2(Math.sin(goal.yaw - camera.yaw), Math.cos(goal.yaw - camera.yaw));
    camera.yaw += .2 * turn;
    camera.pitch += .2 * (goal.pitch - camera.pitch);
    camera.distance *= (goal.distance / camera.distance) ** .2;
    camera.target = camera.target.map((value, i) => value + .2 * (goal.target[i] - value));
    const left = Math.abs(turn) + Math.hypot(...less(goal.target, camera.target)) / goal.distance +
        Math.abs(goal.pitch - camera.pitch) + Math.abs(Math.log(goal.distance / camera.distance));
    if (left < .002) goal = null;
    moved = true;
  }

  /**
   * The place of a path, else of a point or the grid, that is seen nearest to a pixel of the window,
   * at most `reach` pixels off, in the clouds' frame; null where none is.
   */
  function placeAt(clientX, clientY, reach) {
    const box = canvas.getBoundingClientRect(), ratio = canvas.height / box.height;
    const x = (clientX - box.left) * ratio, y = (box.bottom - clientY) * ratio;
    return pathAt(x, y, reach * ratio) || depthAt(Math.floor(x), Math.floor(y), Math.round(reach * ratio));
  }
  function pathAt(x, y, reach) {
    const look = lens(), boxes = root.querySelectorAll('.path');
    let best = null;
    for (const place of data.paths.flatMap((path, i) => boxes[i].checked ? path.pieces.flat() : [])) {
      const away = less(place, camera.target), distance = dot(look.ahead, away) + camera.distance;
      if (distance < look.near) continue;
      const apart = Math.hypot((1 + dot(look.right, away) * look.x / distance) * canvas.width / 2 - x,
                               (1 + dot(look.up, away) * look.y / distance) * canvas.height / 2 - y);
      if (apart < (best ? best.apart : reach)) best = {apart, place};
    }
    return best && best.place;
  }
  // From the depth of the pixels, d = 1 - near / distance along the view.
  function depthAt(column, row, reach) {
    draw(1, 1, true);
    gl.useProgram(depth.program);
    gl.bindTexture(gl.TEXTURE_2D, textures[1]);
    gl.uniform1i(depth.depths, 0);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const side = 2 * reach + 1, bytes = new Uint8Array(4 * side * side);
    gl.readPixels(column - reach, row - reach, side, side, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    redraw();
    let best = null;
    for (let i = 0; i < side * side; ++i) {
      const x = i % side - reach, y = Math.floor(i / side) - reach, apart = x * x + y * y;
      const bits = bytes[4 * i] << 16 | bytes[4 * i + 1] << 8 | bytes[4 * i + 2];
      if (bits > 0 && bits < 16777215 && (!best || apart < best.apart)) best = {apart, x: column + x, y: row + y, bits};
    }
    if (!best) return null;
    const look = lens(), distance = look.near / (1 - best.bits / 16777215);
    const right = (2 * (best.x + .5) / canvas.width - 1) * distance / look.x, up = (2 * (best.y + .5) / canvas.height - 1) * distance / look.y;
    return camera.target.map((value, i) => value + look.ahead[i] * (distance - camera.distance) + look.right[i] * right + look.up[i] * up);
  }

  // Two places that were picked, and the distance between them.
  let picked = null;  // null: nothing is measured
  function showMeasured(note) {
    const cross = place => [0, 1, 2].map(axis => [-1, 1].map(sign =>
        place.map((value, i) => value + (i === axis ? sign * .012 * camera.distance : 0))));
    gl.deleteBuffer(measured.buffer);
    measured = linesOf(picked ? [...picked.flatMap(cross), ...(picked.length === 2 ? [picked] : [])] : []);
    find('.measure').classList.toggle('chosen', Boolean(picked));
    find('.distance').hidden = !picked;
    if (picked) find('.distance').textContent = note || distanceText(picked);
    redraw();
  }
  function distanceText([from, to]) {
    if (!to) return from ? 'Click or tap the second point' : 'Click or tap the first point';
    const along = less(to, from);
    return `${Math.hypot(...along).toFixed(2)} m (${Math.hypot(along[0], along[1]).toFixed(2)} m level, ${Math.abs(along[2]).toFixed(2)} m ${along[2] < 0 ? 'down' : 'up'})`;
  }
  function pick(event) {
    const place = placeAt(event.clientX, event.clientY, event.pointerType === 'touch' ? 16 : 6);
    if (place) picked = picked.length === 1 ? [...picked, place] : [place];
    showMeasured(place ? '' : 'No point is there: click or tap nearer to one');
  }
  find('.measure').onclick = () => { picked = picked ? null : []; showMeasured(); };

  let following = false;
  const takeOver = () => { goal = null; following = false; };
  const turnBy = (yaw, pitch) => {
    takeOver();
    camera.yaw += yaw;
    camera.pitch = clamp(camera.pitch + pitch, -.3, Math.PI / 2);
    redraw(true);
  };
  const moveBy = (right, up) => {  // pixels, over the ground
    takeOver();
    const scale = camera.distance / lens().focal * canvas.height / canvas.clientHeight;
    const [cy, sy] = [Math.cos(camera.yaw), Math.sin(camera.yaw)];
    const far = up / Math.max(.35, Math.sin(camera.pitch));
    camera.target[0] += scale * (right * sy + far * cy);
    camera.target[1] += scale * (far * sy - right * cy);
    redraw(true);
  };
  const zoomBy = factor => {
    takeOver();
    camera.distance = clamp(camera.distance * factor, .5, 20 * data.radius);
    redraw(true);
  };

  // Mouse and fingers: one turns, two move and zoom.
  const fingers = new Map();
  let pressed = null;  // where the only one was put down
  canvas.onpointerdown = event => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    pressed = fingers.size === 1 ? [event.clientX, event.clientY] : null;
  };
  canvas.onpointerup = canvas.onpointercancel = event => {
    fingers.delete(event.pointerId);
    const stayed = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 6;
    if (picked && stayed && event.type === 'pointerup' && event.button === 0) pick(event);
  };
  canvas.onpointermove = event => {
    const was = fingers.get(event.pointerId);
    if (!was) return;
    const [x, y] = [event.clientX, event.clientY], [dx, dy] = [x - was[0], y - was[1]];
    fingers.set(event.pointerId, [x, y]);
    if (fingers.size === 2) {
      const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      const apart = place => Math.max(10, Math.hypot(place[0] - other[0], place[1] - other[1]));
      zoomBy(apart(was) / apart([x, y]));
      moveBy(-dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons & 6) {
      moveBy(-dx, dy);
    } else {
      turnBy(-.006 * dx, .006 * dy);
    }
  };
  canvas.oncontextmenu = event => event.preventDefault();
  canvas.onwheel = event => {  // of a page that scrolls only once it was clicked on
    if (document.activeElement !== canvas && document.documentElement.scrollHeight > innerHeight) return;
    event.preventDefault();
    zoomBy(Math.exp(event.deltaY / 700));
  };
  canvas.onkeydown = event => {
    const step = {ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
    if (step && event.shiftKey) moveBy(-40 * step[0], 40 * step[1]);
    else if (step) turnBy(.06 * step[0], .06 * step[1]);
    else if (event.key === '+') zoomBy(.9);
    else if (event.key === '-') zoomBy(1 / .9);
    else if (event.key === ' ' && data.scans.length) play();
    else return;
    event.preventDefault();
  };

  // Buttons and choices.
  const views = {
    overview: () => ({target: data.centre, distance: wholeFrom(2.4), yaw: camera.yaw, pitch: .62}),
    above: () => ({target: data.centre, distance: wholeFrom(2.2), yaw: Math.PI / 2, pitch: Math.PI / 2}),
    behind: () => {
      const scan = data.scans[Math.max(0, shown.scan - 1)];
      return {target: scan.at, distance: 26, yaw: scan.yaw, pitch: .38};
    },
  };
  for (const button of root.querySelectorAll('[data-view]')) {
    button.onclick = () => {
      following = button.dataset.view === 'behind';
      if (following && shown.scan === 0) show(1);
      goal = views[button.dataset.view]();
      redraw(true);
    };
  }
  const release = things => things.forEach(old => { gl.deleteBuffer(old.buffer); gl.deleteBuffer(old.shine); });
  function show(scan) {
    const before = data.scans[shown.scan - 1], seen = data.scans[scan - 1];
    if (before !== seen && before?.load) { release([before.measured, before.upsampled]); delete before.measured; delete before.upsampled; }
    if (seen?.load && !seen.measured) Object.assign(seen, seen.load());
    shown.scan = scan;
    find('.scan').value = scan;
    onscan(scan - 1);
    find('output').textContent = seen ? seen.name : 'the map alone';
    const arrow = (forward, left) => seen.at.map((value, i) => value + (i === 2 ? 0 :
        i === 0 ? forward * Math.cos(seen.yaw) - left * Math.sin(seen.yaw)
                : forward * Math.sin(seen.yaw) + left * Math.cos(seen.yaw)));
    gl.deleteBuffer(sensor.buffer);
    sensor = linesOf(seen ? [[arrow(-1, 0), arrow(2, 0)], [arrow(2, 0), arrow(1.1, .6)], [arrow(2, 0), arrow(1.1, -.6)]] : []);
    if (seen && following) goal = views.behind();
    redraw(true);
  }
  let timer = 0;
  function play() {
    if (timer) { clearInterval(timer); timer = 0; }
    else timer = setInterval(() => show(shown.scan % data.scans.length + 1), 200);
    find('.play').textContent = timer ? 'Stop' : 'Play';
  }
  find('.play').onclick = play;
  root.renew = fresh => {  // for a page that is updated
    release([...paths, loops, ...data.clouds, ...data.scans.flatMap(scan => [scan.measured, scan.upsampled]).filter(Boolean)]);
    if (fresh.drive) fresh.scans = scansOf(fresh.drive);
    Object.assign(data, {...fresh, paths: fresh.paths.map((path, i) => ({...data.paths[i], ...path}))});
    takeLines();
    find('.scan').max = data.scans.length;
    choose();
    show(Math.min(shown.scan, data.scans.length));
  };
  root.sensorAt = pose => {
    Object.assign(data.scans[0], pose);
    show(shown.scan);
  };
  find('.scan').max = data.scans.length;
  find('.scan').oninput = event => show(Number(event.target.value));
  root.querySelectorAll('input[type=checkbox]').forEach(box => { box.onchange = () => redraw(); });
  find('.full').hidden = !document.fullscreenEnabled;
  find('.full').onclick = () => document.fullscreenElement ? document.exitFullscreen() : root.requestFullscreen();
  for (const cloud of data.clouds) find('.cloud').add(new Option(cloud.name));
  function choose() {
    shown.cloud = Math.max(0, find('.cloud').selectedIndex);
    find('.key').hidden = !data.clouds[shown.cloud]?.blocks.length;
    const {sure, bright = []} = data.clouds[shown.cloud] || {};
    const colour = find('.colour');
    [true, sure, bright.length].forEach((known, i) => { colour[i].disabled = colour[i].hidden = !known; });
    if (colour.selectedOptions[0].disabled) colour.selectedIndex = 0;
    colour.parentElement.hidden = !sure && !bright.length;
    shown.by = colour.selectedIndex;
    const stops = kPalettes[shown.by].map(stop => `rgb(${stop.map(part => 255 * part)})`);
    find('.key i').style.background = `linear-gradient(90deg, ${stops})`;
    const ends = [data.heights.map(height => height.toFixed(1) + ' m'), ['0', '1: certain'],
                  bright.map(value => String(Number(value.toPrecision(2))))][shown.by];
    find('.key .low').textContent = ends[0];
    find('.key .high').textContent = ends[1];
    redraw();
  }
  find('.cloud').onchange = find('.colour').onchange = choose;
  new ResizeObserver(() => redraw()).observe(canvas);

  // A link can name the view: page.html#yaw=0.5&pitch=0.3&distance=40&scan=3&colour=2
  const asked = Object.fromEntries([...new URLSearchParams(location.hash.slice(1))]
      .map(([name, value]) => [name, Number(value)]));
  for (const name of ['yaw', 'pitch', 'distance']) if (Number.isFinite(asked[name])) camera[name] = asked[name];
  if (asked.cloud in data.clouds) find('.cloud').selectedIndex = asked.cloud;
  if (asked.colour in kPalettes) find('.colour').selectedIndex = asked.colour;
  choose();
  const apart = data.scans.map(scan => Math.abs(scan.number - asked.scan));  // NaN: none was asked for
  if (data.scans.length) show(apart.indexOf(Math.min(...apart)) + 1);
  if (shown.scan) camera.target = [...data.scans[shown.scan - 1].at];
  return root;
}

/** The cells of an occupancy grid: 0 unknown, 1 free, 2 occupied. */
function cellsOf(grid) {
  const packed = numbersOf(grid.cells);
  return Uint8Array.from({length: grid.rows * grid.columns}, (_, i) => packed[i >> 2] >> 2 * (i & 3) & 3);
}

/** The points of a cloud, x and y in metres: what a map from above is drawn from. */
function placesOf(cloud) {
  const words = new Uint32Array(bytesOf(cloud.points).buffer), xs = new Float32Array(words.length), ys = new Float32Array(words.length);
  let i = 0;
  for (const [x, y, , end] of cloud.blocks) {
    for (const last = i + end; i < last; ++i) {
      xs[i] = cloud.origin[0] + (512 * x + (words[i] & 511) + .5) * cloud.step;
      ys[i] = cloud.origin[1] + (512 * y + (words[i] >> 9 & 511) + .5) * cloud.step;
    }
  }
  return [xs, ys];
}
