import { Link } from "./link.js";

const AGAIN = 1000; // [ms] until the next attempt to reach the program
const GONE = "The program that draws this has ended or cannot be reached: the picture stands still. Trying again…";

/** @param {HTMLElement} host the element that shows the scene of the program that serves this page */
export function follow(host) {
  /** @type {Record<string, any>} */
  let state = { height: 0 };
  /** @type {(message: any, buffers: DataView[]) => void} */
  let hear = () => {};
  /** @type {WebSocket | null} */
  let connected = null;
  const model = { // replaces a widget's model: the same messages over a WebSocket
    get: (/** @type {string} */ name) => state[name],
    set: (/** @type {string} */ name, /** @type {any} */ value) => (state[name] = value),
    on: (/** @type {string} */ name, /** @type {typeof hear} */ told) => name === "msg:custom" && (hear = told),
    send: (/** @type {any} */ content) => connected?.readyState === 1 && connected.send(JSON.stringify(content)),
  };
  /** @type {Link | null} */
  let link = null;
  const say = (/** @type {string} */ text) => (link ? link.say(text, true) : (host.textContent = text));
  /** @param {any} message @param {DataView[]} buffers */
  const take = (message, buffers) => {
    if (link) return hear(message, buffers);
    state = { ...state, ...message, snapshot: buffers[0] };
    link = new Link(model);
    link.show(host);
  };
  const open = () => {
    const socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => take(...unframed(new Uint8Array(data)));
    socket.onopen = () => {
      connected = socket;
      say("");
      link?.count();
    };
    socket.onclose = () => {
      say(GONE);
      setTimeout(open, AGAIN);
    };
  };
  open();
}

/** @param {Uint8Array} bytes see Python's `frame_message` @returns {[any, DataView[]]} */
function unframed(bytes) {
  const end = bytes.indexOf(10);
  const { sizes, ...message } = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
  let at = end + 1;
  const buffers = sizes.map((/** @type {number} */ size) => new DataView(bytes.buffer, (at += size) - size, size));
  return [message, buffers];
}
