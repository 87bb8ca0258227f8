import { Link } from "./link.js";

const AGAIN = 1000; // [ms] until the next attempt to reach the program
const GONE = "The program that draws this has ended or cannot be reached: the picture stands still. Trying again…";

/** Stands for a widget's model where a page belongs to a program: the same messages, over a WebSocket. */
class SocketModel {
  constructor() {
    /** @type {Record<string, any>} */
    this.state = { height: 0 };
    this.get = (/** @type {string} */ name) => this.state[name];
    this.set = (/** @type {string} */ name, /** @type {any} */ value) => (this.state[name] = value);
    /** @type {(message: any, buffers: DataView[]) => void} */
    this.hear = () => {};
    /** @type {WebSocket | null} */
    this.socket = null;
  }

  /** @param {string} _ @param {(message: any, buffers: DataView[]) => void} hear */
  on(_, hear) {
    this.hear = hear;
  }

  /** @param {any} content */
  send(content) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(content));
  }
}

/** @param {HTMLElement} host shows the scene of the program that this page came from, and follows it */
export function follow(host) {
  const model = new SocketModel();
  const status = Object.assign(document.createElement("div"), { role: "status", hidden: true });
  status.style.cssText = "padding:4px 8px;background:#fd8;color:#000;font:13px system-ui,sans-serif";
  host.before(status);
  /** @type {Link | null} */
  let link = null;
  /** @param {any} message @param {DataView[]} buffers */
  const take = (message, buffers) => {
    if (link) return model.hear(message, buffers);
    model.state = { ...model.state, ...message, snapshot: buffers[0] };
    link = new Link(model);
    link.show(host);
  };
  const open = () => {
    const socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => take(...unframed(new Uint8Array(data)));
    socket.onopen = () => {
      model.socket = socket;
      [status.hidden, status.textContent] = [true, ""];
      link?.count();
    };
    socket.onclose = () => {
      [status.hidden, status.textContent] = [false, GONE];
      setTimeout(open, AGAIN);
    };
  };
  open();
}

/** @param {Uint8Array} bytes see Python's `framed` @returns {[any, DataView[]]} */
function unframed(bytes) {
  const end = bytes.indexOf(10);
  const { sizes, ...message } = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
  let at = end + 1;
  const buffers = sizes.map((/** @type {number} */ size) => new DataView(bytes.buffer, (at += size) - size, size));
  return [message, buffers];
}
