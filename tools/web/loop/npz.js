'use strict';
// numpy's files: .npy, and .npz with its members deflated.

/** {shape, values} of the bytes of an .npy file. */
function npyArray(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset), wide = bytes[6] > 1;
  const start = (wide ? 12 : 10) + (wide ? view.getUint32(8, true) : view.getUint16(8, true));
  const header = new TextDecoder().decode(bytes.subarray(10, start));
  const shape = header.match(/'shape': \(([^)]*)\)/)[1].split(',').filter(text => text.trim()).map(Number);
  const kind = header.match(/'descr': '([^']*)'/)[1], body = bytes.slice(start).buffer;
  const types = {'<f4': Float32Array, '<f8': Float64Array, '|u1': Uint8Array, '<i8': BigInt64Array};
  return {shape, values: new types[kind](body)};
}

/** Its arrays by name. */
async function npzArrays(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset), arrays = {};
  let end = bytes.length - 22;
  while (view.getUint32(end, true) !== 0x06054b50) --end;
  let entry = view.getUint32(end + 16, true);
  for (let left = view.getUint16(end + 10, true); left > 0; --left) {
    const packed = view.getUint32(entry + 20, true), local = view.getUint32(entry + 42, true);
    const nameLength = view.getUint16(entry + 28, true);
    const name = new TextDecoder().decode(bytes.subarray(entry + 46, entry + 46 + nameLength));
    const start = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
    const member = new Blob([bytes.subarray(start, start + packed)]).stream();
    const isDeflated = view.getUint16(entry + 10, true) === 8;
    const whole = isDeflated ? member.pipeThrough(new DecompressionStream('deflate-raw')) : member;
    arrays[name.replace(/\.npy$/, '')] = npyArray(new Uint8Array(await new Response(whole).arrayBuffer()));
    entry += 46 + nameLength + view.getUint16(entry + 30, true) + view.getUint16(entry + 32, true);
  }
  return arrays;
}
