import { Link } from "./link.js";

const RETRY_AFTER = 1000; // [ms] until the next attempt to reach the program
const GONE = "The program that draws this has ended or cannot be reached: the picture stands still. Trying again…";

/** @param {HTMLElement} host the element that shows the scene of the program that serves this page */
export function follow(host) {
  /** @type {Record<string, any>} */
  let state = { height: 0 };
  /** @type {(message: any, buffers: DataView[]) => void} */
  let onMessage = () => {};
  /** @type {WebSocket | null} */
  let connected = null;
  const model = { // replaces a widget's model: the same messages over a WebSocket
    get: (/** @type {string} */ name) => state[name],
    set: (/** @type {string} */ name, /** @type {any} */ value) => (state[name] = value),
    on: (/** @type {string} */ name, /** @type {typeof onMessage} */ handler) => name === "msg:custom" && (onMessage = handler),
    send: (/** @type {any} */ content) => connected?.readyState === 1 && connected.send(JSON.stringify(content)),
  };
  /** @type {Link | null} */
  let link = null;
  const showMessage = (/** @type {string} */ text) => (link ? link.showMessage(text, true) : (host.textContent = text));
  /** @param {any} message @param {DataView[]} buffers */
  const receive = (message, buffers) => {
    if (link) return onMessage(message, buffers);
    state = { ...state, ...message, snapshot: buffers[0] };
    link = new Link(model);
    link.show(host);
  };
  const open = () => {
    const socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => receive(...parseFrame(new Uint8Array(data)));
    socket.onopen = () => {
      connected = socket;
      showMessage("");
      link?.reportViewCount();
    };
    socket.onclose = () => {
      showMessage(GONE);
      setTimeout(open, RETRY_AFTER);
    };
  };
  open();
}

/** @param {Uint8Array} bytes see Python's `frame_message` @returns {[any, DataView[]]} */
function parseFrame(bytes) {
  const end = bytes.indexOf(10);
  const { sizes, ...message } = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
  let start = end + 1;
  const buffers = sizes.map((/** @type {number} */ size) => new DataView(bytes.buffer, (start += size) - size, size));
  return [message, buffers];
}
