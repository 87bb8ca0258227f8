// The module of every widget. It is small, because the viewer's code is sent once per kernel in a separate model.
// Python replaces __KEY__, which identifies a version of the viewer's code.

const page = /** @type {any} */ (globalThis);
/** @type {Map<string, Promise<any>>} */
const links = new Map();

/** @param {any} model */
async function load(model) {
  const shared = await model.widget_manager.get_model(model.get("code"));
  const zipped = new Blob([shared.get("code")]).stream();
  const text = await new Response(zipped.pipeThrough(new DecompressionStream("gzip"))).text();
  const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  await import(address);
  URL.revokeObjectURL(address);
  return page["__KEY__"];
}

const LATE = 4000; // [ms] longer than JupyterLab's views poll for their model

// A view of jupyterlab_widgets 3.0 polls for its model for 2 s. If a reloaded page receives the models in the last pause,
// the view finds the manager restored and permanently shows "model not found". While `restoredStatus` is false, it waits.
/** @param {any} manager JupyterLab's manager of one notebook; other hosts have no `restored`. */
function renderLateViews(manager) {
  if (!manager.restored?.emit || manager.__KEY__late) return;
  manager.__KEY__late = true;
  const isRestored = () => Reflect.get(Object.getPrototypeOf(manager), "restoredStatus", manager);
  Object.defineProperty(manager, "restoredStatus", { value: false, configurable: true });
  /** @param {boolean} wasRestored a busy machine takes longer than LATE */
  const again = (wasRestored) =>
    setTimeout(() => {
      if (wasRestored) delete manager.restoredStatus;
      else again(isRestored());
      manager.restored.emit(undefined);
    }, LATE);
  again(isRestored());
}

export default {
  /** @param {any} props Must return at once: anywidget waits two seconds and loses messages. */
  initialize({ model }) {
    renderLateViews(model.widget_manager);
    /** @type {any[][]} */
    const early = [];
    /** @type {any} */
    let link = null;
    const keep = (/** @type {any[]} */ ...message) => early.push(message);
    model.on("msg:custom", keep);
    const pending = (page["__KEY__loading"] ??= load(model).catch((error) => {
      delete page["__KEY__loading"]; // the next widget tries again
      throw error;
    }));
    links.set(
      model.get("name"),
      pending.then((/** @type {any} */ viewer) => {
        model.off("msg:custom", keep);
        link = new viewer.Link(model);
        for (const message of early) link.receive(...message);
        return link;
      }),
    );
    return () => link?.close();
  },
  /** @param {{model: any, el: HTMLElement}} props */
  async render({ model, el }) {
    try {
      return (await links.get(model.get("name"))).show(el);
    } catch (error) {
      el.textContent = `The 3D view could not start: ${error}`;
    }
  },
};
