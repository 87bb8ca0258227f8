/** @type {Record<string, number>} */
const ARRAYS = { Uint8Array: 0x12, Int32Array: 0x15, Uint32Array: 0x16, Float32Array: 0x17 };

/**
 * Write msgpack, with arrays as meshcat's decoder reads them.
 * @param {any} value of JSON's kinds, or a typed array @returns {Uint8Array}
 */
export function encode(value) {
  /** @type {Uint8Array[]} */
  const parts = [];
  write(value, parts);
  const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let offset = 0;
  for (const part of parts) {
    all.set(part, offset);
    offset += part.length;
  }
  return all;
}

/** @param {any} value @param {Uint8Array[]} parts */
function write(value, parts) {
  if (value === null || value === undefined) parts.push(Uint8Array.of(0xc0));
  else if (typeof value === "boolean") parts.push(Uint8Array.of(value ? 0xc3 : 0xc2));
  else if (typeof value === "number") parts.push(head(0xcb, value, 8));
  else if (typeof value === "string") {
    const text = new TextEncoder().encode(value);
    parts.push(head(0xdb, text.length), text);
  } else if (ArrayBuffer.isView(value)) {
    const bytes = new Uint8Array(value.buffer, value.byteOffset, value.byteLength);
    parts.push(head(0xc9, bytes.length), Uint8Array.of(ARRAYS[value.constructor.name]), bytes);
  } else if (Array.isArray(value)) {
    parts.push(head(0xdd, value.length));
    for (const member of value) write(member, parts);
  } else {
    const members = Object.entries(value);
    parts.push(head(0xdf, members.length));
    for (const member of members.flat(1)) write(member, parts);
  }
}

/** @param {number} code @param {number} value a length, or a number of eight bytes @param {4 | 8} [size] */
function head(code, value, size = 4) {
  const view = new DataView(new ArrayBuffer(1 + size));
  view.setUint8(0, code);
  if (size === 4) view.setUint32(1, value);
  else view.setFloat64(1, value);
  return new Uint8Array(view.buffer);
}
