/* global MeshCat */

/**
 * Read msgpack with the decoder inside meshcat's bundle, which does not export it.
 * @param {Uint8Array} bytes @returns {any}
 */
export function decode(bytes) {
  let value;
  const catcher = { handle_command: (/** @type {any} */ decoded) => (value = decoded) };
  MeshCat.Viewer.prototype.handle_command_bytearray.call(catcher, bytes);
  return value;
}

/**
 * Look at a buffer as bytes, whatever a front-end made of it.
 * @param {DataView | Uint8Array | ArrayBuffer} buffer @returns {Uint8Array}
 */
export function bytesOf(buffer) {
  if (buffer instanceof ArrayBuffer) return new Uint8Array(buffer);
  return new Uint8Array(buffer.buffer, buffer.byteOffset, buffer.byteLength);
}
