/* global MeshCat */

/**
 * Read msgpack with the decoder inside meshcat's bundle, which does not export it.
 * @param {DataView | Uint8Array | ArrayBuffer} buffer the bytes in the front end's type @returns {any}
 */
export function decode(buffer) {
  let value;
  const catcher = { handle_command: (/** @type {any} */ decoded) => (value = decoded) };
  const bytes = buffer instanceof ArrayBuffer ? new DataView(buffer) : buffer;
  const plain = new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  MeshCat.Viewer.prototype.handle_command_bytearray.call(catcher, plain);
  return value;
}
