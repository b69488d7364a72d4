'use strict';
// The scans of a drive, kept as range images (C++: drive_scans.h): each is read when it is shown.

/** The first `count` numbers of a code; NaN: none. */
function numbersOfCode(code, count) {
  const bytes = bytesOf(code);
  let last = 0, place = 0;
  return Float32Array.from({length: count}, () => {
    let value = 0, bits = 0, unit;
    do {
      unit = bytes[place >> 1] >> 4 * (place & 1) & 15;
      value |= (unit & 7) << bits;
      bits += 3;
      ++place;
    } while (unit & 8);
    if (!value) return NaN;
    return last += value & 1 ? value >> 1 : -(value >> 1);
  });
}

/** Places in metres as a cloud that cloud.js draws. */
function packedCloud(places, around) {
  const step = .03, side = 512, blocks = new Map();
  const reach = places.reduce((most, place) => Math.max(most, ...less(place, around).map(Math.abs)), 0) + step;
  const origin = around.map(value => value - reach);
  for (const place of places) {
    const steps = less(place, origin).map(value => Math.floor(value / step)), corner = steps.map(n => Math.floor(n / side));
    const [x, y, z] = steps.map((n, axis) => n - side * corner[axis]), key = corner.join();
    if (!blocks.has(key)) blocks.set(key, {corner, words: []});
    blocks.get(key).words.push(x | y << 9 | z << 18);
  }
  const all = [...blocks.values()];
  return {origin, step, spacing: step, points: Uint32Array.from(all.flatMap(block => block.words)),
          blocks: all.map(({corner, words}) => [...corner, words.length])};
}

/** What a pose, three rows of a matrix, makes of a place. */
const movedBy = pose => place => [0, 4, 8].map(i => pose[i] * place[0] + pose[i + 1] * place[1] + pose[i + 2] * place[2] + pose[i + 3]);

/** The metres of each pixel of a scan; NaN: no return. */
const rangesOf = (drive, scan) =>
    numbersOfCode(scan.code, scan.columns * (1 + drive.rows.length)).subarray(scan.columns).map(n => n * drive.range_step_m);

/** The clouds of a scan, each point where the sensor was when it measured the point's column. */
function cloudsOf(drive, scan) {
  const times = numbersOfCode(scan.code, scan.columns), ranges = rangesOf(drive, scan), measured = [], upsampled = [];
  const pose = numbersOf(scan.pose), here = movedBy(pose), there = movedBy(numbersOf(scan.other));
  const every = Math.round(drive.columns / scan.columns);
  ranges.forEach((range, i) => {
    if (!(range > 0)) return;
    const row = drive.rows[Math.floor(i / scan.columns)], column = i % scan.columns;
    const azimuth = row.first_azimuth_rad - 2 * Math.PI * every * column / drive.columns;
    const level = range * Math.cos(row.elevation_rad);
    const place = [level * Math.cos(azimuth), level * Math.sin(azimuth), range * Math.sin(row.elevation_rad)];
    const share = times[column] * drive.time_step_s / scan.other_s, from = here(place), to = there(place);
    (row.measured ? measured : upsampled).push(from.map((value, axis) => value + (Number.isFinite(share) ? share * (to[axis] - value) : 0)));
  });
  const at = [pose[3], pose[7], pose[11]];
  return {measured: packedCloud(measured, at), upsampled: packedCloud(upsampled, at)};
}

/** The scans for turningView(): those of a drive get their clouds from load(). */
function scansOf(drive) {
  return drive.scans.map(scan => {
    const pose = numbersOf(scan.pose);
    return {...scan, at: [pose[3], pose[7], pose[11]], yaw: Math.atan2(pose[4], pose[0]), load: () => cloudsOf(drive, scan)};
  });
}

/** The range images of the scans: its show(i) shows the i-th. */
function rangeImageOf(drive) {
  const {rows, scans: [{columns}]} = drive, isUpsampled = rows.some(row => !row.measured);
  const every = Math.round(drive.columns / columns);
  const image = imageFigure({
    rows: rows.length, columns, every, height: `${clamp(rows.length / 16, 4, 7)}rem`,
    elevation_deg: rows.map(row => row.elevation_rad * 180 / Math.PI), scale: rangeScale(drive.max_range_m), unit: 'm',
    label: row => isUpsampled ? rows[row].measured ? 'measured' : 'upsampled' : ''});
  const show = image.show;
  image.show = i => show({values: rangesOf(drive, drive.scans[i]), scale: rangeScale(drive.max_range_m), unit: 'm'});
  return image;
}
