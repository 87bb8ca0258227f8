// An extension of JupyterLab. Where a widget's kernel has ended, its output shows what was saved beside the
// widget: a picture or HTML. It also divides the page between a notebook and the view beside it. It is a module of
// JupyterLab's module federation, written by hand so that no build is needed: `init` gets the modules that JupyterLab
// shares, `get` returns the plugin.
(() => {
  const WIDGET = "application/vnd.jupyter.widget-view+json";
  const UNTRUSTED = "application/x.course-lib.untrusted-widget"; // of a notebook that came from another computer
  const SAVED_TYPES = ["text/html", "image/png", "text/plain"]; // in the order of preference
  const WIDGET_TIMEOUT = 600; // [ms] that a widget may take to appear before the saved picture is shown
  const MODEL_TIMEOUT = 2000; // [ms] that a widget's model may take to arrive, as in jupyterlab-widgets
  const RESTORE_TIMEOUT = 10000; // [ms] that JupyterLab may take to start a kernel and to ask it for its widgets
  const BARE_REPR = /^\w+\(\w+=/; // text/plain of a widget for which nothing was saved
  const NO_SAVED_OUTPUT = "A control was here. Run its cell to use it again.";
  const CONTINUE = "Continue here";
  const CONTINUE_TITLE = "Run what this cell needs, then the cell itself";
  const AS_SAVED = "As it was when the notebook was saved.";
  const KERNEL_ENDED = "The kernel has ended.";
  const VIEW_CLOSED = "The view was closed.";
  // Statuses of a kernel that has ended. A restart by another window is seen as "starting" only.
  const ENDED_STATUSES = ["dead", "terminating", "restarting", "autorestarting", "starting"];
  const INSERTION_TIMEOUT = 2000; // [ms] that JupyterLab may take to insert an output into its cell
  const CODE_COLUMNS = 88; // of code that stay readable beside a view
  const NOTEBOOK_SHARE = 0.6; // of the notebook, where a view is beside it
  const MIN_VIEW_WIDTH = 420; // [px] width of a view beside the notebook
  const NARROW_WINDOW = 900; // [px] width of a window of which the file browser would take a third or more
  const PANEL_TITLE = "RViz"; // in the title of a panel with a view

  const IDENTITY_TARGET = "course-lib:identity"; // of the comm by which a kernel reports the student's ID

  /** Modules that JupyterLab shares: name, version, entry. */
  let scope = {};

  /** Return a shared module in the version that others have loaded, or undefined. */
  async function shared(name) {
    const entries = Object.values(scope[name] ?? {});
    const entry = entries.find(({ loaded }) => loaded) ?? entries[entries.length - 1];
    return entry && (await entry.get())();
  }

  /** Return the code cell that an output belongs to, or undefined. */
  function cellOf(tracker, widget) {
    let area = widget;
    for (; widget; widget = widget.parent) {
      if (widget.model?.type === "code") return widget;
      area = widget;
    }
    // JupyterLab renders the outputs of cells that were never in sight, and inserts them when the reader scrolls there.
    const panel = tracker.find(({ content }) => content.widgets.some((cell) => cell.outputArea === area));
    return panel?.content.widgets.find((cell) => cell.outputArea === area);
  }

  /** Return the code cell of an output, which JupyterLab may insert after it has rendered it, or undefined outside cells. */
  async function waitForCell(tracker, widget) {
    const until = performance.now() + INSERTION_TIMEOUT;
    while (!widget.isDisposed && !cellOf(tracker, widget) && performance.now() < until)
      await new Promise((done) => setTimeout(done, 50)); // [ms]
    return cellOf(tracker, widget);
  }

  /** Run what a cell needs, then the cell; `report` shows its progress and errors. */
  async function continueAt(app, tracker, cell, report) {
    const panel = tracker.find((one) => one.content.widgets.includes(cell));
    if (!panel) return;
    await panel.context.save(); // the kernel reads the cells from the file
    const context = panel.sessionContext;
    if (!context.session?.kernel) {
      report("Starting a kernel …");
      await context.startKernel(); // it was culled, or shut down by hand
    }
    const kernel = context.session?.kernel;
    if (!kernel) return report("Choose a kernel first: menu Kernel, Change Kernel.");
    report("Running what this cell needs …");
    const code = "%load_ext course_lib\nfrom course_lib import resume\nresume()";
    const metadata = { cellId: cell.model.sharedModel.getId() };
    const future = kernel.requestExecute({ code, store_history: false }, true, metadata);
    let errorText = "";
    future.onIOPub = ({ header, content }) => {
      if (header.msg_type === "error") errorText = `${content.ename}: ${content.evalue}`;
    };
    const reply = await future.done;
    if (reply.content.status !== "ok") return report(errorText || "The kernel has stopped this.");
    report("");
    panel.content.activeCellIndex = panel.content.widgets.indexOf(cell);
    await app.commands.execute("notebook:run-cell");
  }

  /** Return the type of what was saved beside a widget, or undefined. */
  function savedType(data) {
    const type = SAVED_TYPES.find((one) => data[one]);
    return type === "text/plain" && BARE_REPR.test([data[type]].flat().join("")) ? undefined : type;
  }

  /** Show what was saved beside a widget in the place of the widget, and a line below it. */
  async function showSaved(app, tracker, rendermime, renderer, model, line = AS_SAVED) {
    const type = savedType(model.data);
    const parts = [];
    if (type) {
      const saved = rendermime.createRenderer(type);
      await saved.renderModel(model);
      const image = type === "image/png" && saved.node.querySelector("img");
      if (image) image.alt = [model.data["text/plain"] ?? ""].flat().join(""); // what the view shows, in words
      parts.push(saved.node);
    }
    const cell = await waitForCell(tracker, renderer);
    if (renderer.isDisposed || renderer.widgets.length) return;
    renderer.node.replaceChildren(); // before looking for a line: this may be the second time
    parts.push(...createLine(app, tracker, cell, type ? line : NO_SAVED_OUTPUT));
    renderer.show();
    renderer.node.replaceChildren(...parts);
  }

  /** Return a line that says how to go on, with a button, unless another widget of the cell has one. */
  function createLine(app, tracker, cell, text) {
    // The outputs of a cell that was never in sight are not yet in its node.
    if (cell?.outputArea.node.querySelector(".course-saved")) return [];
    const words = document.createElement("span");
    words.textContent = text;
    const line = document.createElement("div");
    line.className = "course-saved";
    line.append(words);
    if (cell) {
      const button = document.createElement("button");
      button.className = "jp-mod-styled jp-mod-minimal";
      Object.assign(button, { type: "button", title: CONTINUE_TITLE, textContent: `▶ ${CONTINUE}` });
      button.onclick = () => continueAt(app, tracker, cell, (text) => (words.textContent = text));
      line.append(" ", button);
    }
    return [line];
  }

  /**
   * Hide the broken links that ipywidgets draws at each control of a kernel that has ended: a line says it once. Break
   * lines of text outputs between words, not within. Break long lines of code as well, with a hanging indent, so that
   * none is hidden beside a view. In narrow windows, break long code in tables, which would push the other columns out
   * of sight.
   */
  function addStyles() {
    const style = document.createElement("style");
    style.textContent = `.jp-Cell:has(.course-saved) .jupyter-widgets-disconnected::before { content: none; }
      .jp-OutputArea-output.jp-RenderedText pre { word-break: normal; overflow-wrap: anywhere; }
      .jp-CodeCell .jp-InputArea-editor .cm-content { white-space: break-spaces; overflow-wrap: anywhere; flex-shrink: 1; }
      .jp-CodeCell .jp-InputArea-editor .cm-line { padding-left: calc(2px + 8ch); text-indent: -8ch; }
      @media (max-width: 900px) { .jp-RenderedMarkdown td code { overflow-wrap: anywhere; } }`;
    document.head.append(style);
  }

  /**
   * Wait for a widget's model as its renderer does, and return false if it is missing. The renderer would log an error
   * for each saved widget without a kernel, and an author or student who looks at the console would search for a fault.
   */
  async function waitForModel(renderer, id) {
    const manager = await renderer._manager?.promise; // no public function returns it
    for (let waited = 0; manager && !manager.has_model(id); waited += 100) {
      // The renderer itself tries again when the widgets have been restored, and logs nothing until then.
      if (waited >= (manager.restoredStatus ? MODEL_TIMEOUT : RESTORE_TIMEOUT)) return !manager.restoredStatus;
      await new Promise((done) => setTimeout(done, 100)); // [ms]
    }
    return true;
  }

  /** Have all widgets' outputs fall back to what was saved, and say below them that their kernel has ended. */
  function showSavedWithoutWidget(app, rendermime, tracker) {
    /** The models of outputs of widgets. */
    const models = new Map();
    const sample = rendermime.createRenderer(WIDGET);
    const prototype = Object.getPrototypeOf(sample);
    sample.dispose();
    const render = prototype.renderModel;
    prototype.renderModel = async function (model) {
      const id = model.data[WIDGET]?.model_id;
      if (!models.has(this)) this.disposed.connect(() => models.delete(this));
      models.set(this, model);
      // The widget is there already: only what is saved beside it has changed.
      if (id && this.courseShows === id && this.widgets.length) return;
      this.courseShows = id;
      const showUnlessThere = (line) => {
        const newest = models.get(this);
        if (newest && !this.isDisposed && !this.widgets.length) showSaved(app, tracker, rendermime, this, newest, line);
      };
      const late = setTimeout(showUnlessThere, WIDGET_TIMEOUT);
      if (!id || (await waitForModel(this, id))) await render.call(this, model);
      clearTimeout(late);
      showUnlessThere();
      const showClosed = () => models.get(this)?.metadata["image/png"]?.fromPage && showUnlessThere(VIEW_CLOSED);
      for (const widget of this.widgets) widget.disposed.connect(() => setTimeout(showClosed));
    };
    return (notebook) => {
      if (notebook.isDisposed) return;
      savePictures(notebook);
      for (const [renderer, model] of [...models]) {
        const cell = cellOf(tracker, renderer);
        if (!cell || !notebook.content.widgets.includes(cell) || !renderer.widgets.length) continue;
        // A view can still be turned. A control would look as if it worked.
        const isView = renderer.node.querySelector(".course-keeps");
        if (isView || !savedType(model.data)) renderer.node.append(...createLine(app, tracker, cell, KERNEL_ENDED));
        else {
          for (const widget of [...renderer.widgets]) widget.parent = null;
          showSaved(app, tracker, rendermime, renderer, model, KERNEL_ENDED);
        }
      }
    };
  }

  /**
   * Show what was saved beside a widget in notebooks that JupyterLab does not trust, too, with the line that says how
   * to go on. JupyterLab renders no widgets there, and without this only the picture would appear. HTML is sanitized.
   */
  function showSavedIfUntrusted(app, rendermime, tracker) {
    const createRenderer = () => {
      const renderer = rendermime.createRenderer(WIDGET);
      renderer.renderModel = (model) => showSaved(app, tracker, rendermime, renderer, model);
      return renderer;
    };
    rendermime.addFactory({ safe: true, mimeTypes: [UNTRUSTED], createRenderer });
    const prototype = Object.getPrototypeOf(rendermime); // each notebook has a registry of its own
    const { preferredMimeType } = prototype;
    prototype.preferredMimeType = function (bundle, safe = "ensure") {
      const isHidden = safe === "ensure" && bundle[WIDGET]?.model_id;
      return isHidden ? UNTRUSTED : preferredMimeType.call(this, bundle, safe);
    };
  }

  /** Return the value of a control as text. */
  function valueOf(control) {
    if (control.type === "range") return ""; // a number is next to it
    if (control.type === "checkbox") return control.checked ? "☑ " : "☐ ";
    if (control.tagName === "SELECT") return control.selectedOptions[0]?.text ?? "";
    return control.value;
  }

  /** Return a drawing as an image, because pages that do not trust a notebook remove SVG. */
  function imageOf(svg) {
    const colors = "--rqt-text: #222; --rqt-back: #fff; --rqt-line: #bbb; --rqt-dim: #666; background: #fff";
    const style = document.createElementNS(svg.namespaceURI, "style");
    style.textContent = `svg { ${colors}; font: 12px system-ui, sans-serif } text { fill: #222 }`;
    svg.prepend(style);
    const bytes = new TextEncoder().encode(new XMLSerializer().serializeToString(svg));
    const image = document.createElement("img");
    image.alt = svg.closest("[aria-label]")?.getAttribute("aria-label") ?? "";
    image.style.maxWidth = "100%";
    image.src = `data:image/svg+xml;base64,${btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""))}`;
    return image;
  }

  /** Return the rows of rqt's topic monitor as a table: without its style sheet they have no columns. */
  function tableOf(rows) {
    const table = document.createElement("table");
    for (const row of rows.querySelectorAll(".rqt-heads, .rqt-row")) {
      const line = table.insertRow();
      for (const { textContent } of row.querySelectorAll("span")) {
        const cell = document.createElement(row.matches(".rqt-heads") ? "th" : "td");
        cell.textContent = textContent.length > 60 ? `${textContent.slice(0, 60)}…` : textContent;
        line.append(cell);
      }
      const value = row.nextElementSibling?.querySelector("pre"); // of a row that is unfolded
      if (value) Object.assign(table.insertRow().insertCell(), { colSpan: line.cells.length }).append(value);
    }
    return table;
  }

  /** Return what a panel of controls shows as HTML, with text in place of controls. */
  function htmlOf(panel) {
    const copy = panel.cloneNode(true);
    copy.classList.remove("course-html");
    const controlsOf = (one) => [...one.querySelectorAll("input, select, textarea")];
    const live = controlsOf(panel); // a copy of a list has not the chosen option
    controlsOf(copy).forEach((control, i) => {
      const value = document.createElement("span");
      value.style.whiteSpace = "pre-wrap";
      if (live[i].type === "number") value.style.cssText = "display: inline-block; min-width: 4em"; // as a column
      value.textContent = valueOf(live[i]);
      control.replaceWith(" ", value); // pages without styles separate it from its label
    });
    for (const button of copy.querySelectorAll("button")) {
      if (button.classList.contains("widget-toggle-button")) {
        const name = document.createElement("span"); // the name of a row that the button unfolds, not a command
        name.textContent = button.textContent;
        name.style.cssText = `display: inline-block; flex: none; width: ${button.style.width}`;
        button.before(name);
      }
      button.remove();
    }
    for (const rows of copy.querySelectorAll(".rqt-wide")) rows.replaceWith(tableOf(rows));
    for (const cell of copy.querySelectorAll("td, th")) cell.style.textAlign = "left"; // JupyterLab's are right
    for (const svg of copy.querySelectorAll("svg:not(.rqt-icon)")) svg.replaceWith(imageOf(svg));
    for (const row of copy.querySelectorAll(".widget-hbox, .widget-inline-hbox, .course-slider"))
      Object.assign(row.style, { display: "flex", flexWrap: "wrap", gap: "2px 12px", alignItems: "baseline" });
    for (const name of copy.querySelectorAll(".course-slider label span")) name.style.display = "inline-block";
    return copy.outerHTML;
  }

  /** Return the element of a widget that brings no HTML of its own, unless it draws on a canvas, or null. */
  function plainWidget(node, data) {
    const isSavedHere = [data["text/html"] ?? ""].flat().join("").includes("jupyter-widgets");
    if (!node || (savedType(data) && !isSavedHere) || node.querySelector("canvas")) return null;
    return node.querySelector(".jp-OutputArea-output > .jupyter-widgets"); // not one that was saved
  }

  /**
   * Let each save of a notebook wait for the one before it. JupyterLab does not: of two saves at the same time, one by
   * its timer, say, the second takes the file that the first has just written for a change by somebody else, and asks
   * whether to overwrite it. A save that waits serves all calls until it starts.
   */
  function queueSaves(context) {
    const save = context.save.bind(context);
    let last = Promise.resolve();
    let waiting = null;
    context.save = () =>
      (waiting ??= last.catch(() => {}).then(() => {
        waiting = null;
        return context.isDisposed ? undefined : (last = save());
      }));
  }

  /**
   * Put an ID that the kit has written into the files of notebooks into those that are open, too. JupyterLab would take
   * it for a change by somebody else, and ask at the next save which of both versions to discard.
   */
  function updateIdentity(tracker, { student, replaced }) {
    tracker.forEach(({ context }) => {
      const { model, contentsModel } = context;
      const hash = replaced[contentsModel?.hash];
      if (!hash) return;
      const { dirty } = model;
      model.setMetadata("course", { ...model.getMetadata("course"), student });
      context._updateContentsModel?.({ ...contentsModel, hash }); // no public function sets the hash
      if (!dirty) context.save(); // what was saved stays saved
    });
  }

  /** Return the cell of each widget, by the widget's model: of several cells, the one that was run last. */
  function newestCells(cells) {
    const newest = new Map();
    for (const cell of cells)
      for (let i = 0; i < cell.model.outputs.length; i++) {
        const id = cell.model.outputs.get(i).data[WIDGET]?.model_id;
        if (!(newest.get(id)?.model.executionCount > cell.model.executionCount)) newest.set(id, cell);
      }
    return newest;
  }

  /**
   * Put what views and controls show now into the notebook, which is about to be saved or changed by a cell. Where
   * several cells show one view, only the last one gets the new picture: each cell keeps the picture of its own step.
   */
  function savePictures(panel) {
    const cells = panel.content.widgets.filter((cell) => cell.model.type === "code");
    const newest = newestCells(cells);
    for (const cell of cells) {
      const { outputs } = cell.model;
      for (let i = 0; i < outputs.length; i++) {
        const { data, metadata: before } = outputs.get(i);
        const id = data[WIDGET]?.model_id;
        // With Run All, the next cell may start before the page has shown this one. Any picture is better than none.
        if (!id || (newest.get(id) !== cell && before["image/png"]?.fromPage)) continue;
        const node = cell.outputArea?.widgets[i]?.node;
        const panel = node?.querySelector(".course-html") ?? plainWidget(node, data);
        const source = node?.querySelector(".course-keeps");
        const kept = panel ? { "text/html": htmlOf(panel) } : source?.courseKeeps?.();
        const isNew = kept && Object.entries(kept).some(([type, value]) => data[type] !== value);
        if (!isNew) continue;
        const output = outputs.get(i).toJSON();
        const text = kept["image/png"] && kept["text/plain"]; // nbconvert reads it in the metadata
        const metadata = text ? { ...output.metadata, "image/png": { alt: text, fromPage: true } } : output.metadata;
        outputs.set(i, { ...output, metadata, data: { ...data, ...kept } });
      }
    }
  }

  /** Return the width [px] that a notebook needs to show CODE_COLUMNS columns of code. */
  function widthForCode(panel) {
    const code = panel.node.querySelector(".jp-CodeCell .cm-content");
    if (!code) return 0;
    const pen = document.createElement("canvas").getContext("2d");
    pen.font = getComputedStyle(code).font;
    const columns = CODE_COLUMNS * pen.measureText("0").width;
    return Math.ceil(panel.node.offsetWidth - code.closest(".cm-scroller").clientWidth + columns + 12); // [px] its margins
  }

  /** Return the handle at the left edge of a widget of the dock, or undefined. */
  function leftEdge({ parent, node }) {
    const edges = [...parent.layout.handles()].filter(
      (one) => one.dataset.orientation === "horizontal" && !one.classList.contains("lm-mod-hidden"),
    );
    return edges.find((one) => Math.abs(one.offsetLeft + one.offsetWidth - node.offsetLeft) < 8);
  }

  const nextFrame = () => new Promise((done) => requestAnimationFrame(done));

  /** Divide the width between a notebook and the panel beside it; `fold` the file browser where both need its place. */
  function divideWidth(notebook, panel, fold) {
    const dock = panel.parent;
    const wide = widthForCode(notebook);
    if (dock.node.offsetWidth < wide + MIN_VIEW_WIDTH) fold();
    return nextFrame().then(nextFrame).then(() => {
      const left = panel.node.offsetLeft;
      const edge = leftEdge(panel);
      if (!edge) return; // the user has moved it
      const whole = panel.node.offsetWidth + left - notebook.node.offsetLeft;
      const share = Math.min(Math.max(NOTEBOOK_SHARE * whole, wide), whole - MIN_VIEW_WIDTH);
      dock.layout.moveHandle(edge, notebook.node.offsetLeft + share, 0);
    });
  }

  /** Place the panels of views beside their notebooks. */
  function arrangePanels(app, tracker) {
    /** Panels by the notebooks whose views they show. */
    const panels = new Map();
    /** Panels that are tabs behind another notebook, because their own is out of sight. */
    const stowed = new Set();
    let isFolded = false; // whether the file browser was folded for them
    const fold = () => {
      if (app.shell.leftCollapsed) return;
      isFolded = true;
      app.shell.collapseLeft();
    };
    const isBeside = (panel) => panel.isAttached && !stowed.has(panel);
    const unfold = () => {
      if (!isFolded || [...panels.values()].some(isBeside)) return;
      isFolded = false;
      if (app.shell.leftCollapsed) app.shell.expandLeft();
    };
    /** Give the whole width to a notebook without a view, which has covered the notebooks of these views. */
    const stow = (notebook) => {
      if (!notebook?.isVisible || panels.has(notebook)) return;
      for (const [owner, panel] of panels) {
        if (owner.isVisible || owner.parent !== notebook.parent || !isBeside(panel)) continue;
        stowed.add(panel);
        panel.parent.addWidget(panel, { mode: "tab-after", ref: owner });
        notebook.parent.selectWidget(notebook);
      }
    };
    /** Show a view next to its notebook, which is in sight again. */
    const unstow = (notebook, panel) => {
      stowed.delete(panel);
      const other = [...panels.values()].find((one) => one !== panel && isBeside(one));
      panel.parent.addWidget(panel, other ? { mode: "tab-after", ref: other } : { mode: "split-right", ref: notebook });
      panel.parent.selectWidget(panel);
      divideWidth(notebook, panel, fold);
    };
    document.addEventListener("course-docked", ({ target, detail }) => {
      const panel = [...app.shell.widgets("main")].find((one) => one.node.contains(target));
      const notebook = tracker.find((one) => one.context === detail.context);
      if (!panel?.parent?.layout?.moveHandle || !notebook || panels.get(notebook) === panel) return;
      const [owner, other] = [...panels].find(([, one]) => isBeside(one)) ?? [];
      panels.set(notebook, panel);
      // As RViz's window, which bears the name of its file: with two notebooks, there are two such panels.
      const updateTitle = () => {
        const { label } = notebook.title;
        panel.title.label = `${PANEL_TITLE}: ${label.replace(/\.ipynb$/, "")}`;
        panel.title.caption = `View of ${label}`;
      };
      updateTitle();
      notebook.title.changed.connect(updateTitle);
      panel.disposed.connect(() => {
        notebook.title.changed.disconnect(updateTitle);
        if (panels.get(notebook) === panel) panels.delete(notebook);
        stowed.delete(panel);
        unfold();
      });
      notebook.disposed.connect(() => panel.isDisposed || panel.dispose());
      app.shell.activateById(notebook.id); // menus and keys act on the notebook
      // JupyterLab has halved the notebook for the new panel, which becomes a tab of the other one.
      // Two notebooks next to each other share the place of the views, and keep the width that they have.
      const isShared = other && owner.isVisible;
      const lefts = isShared && [owner, notebook, other].map(({ node }) => node.offsetLeft);
      if (other) panel.parent.addWidget(panel, { mode: "tab-after", ref: other });
      panel.parent.selectWidget(panel);
      if (!isShared) return divideWidth(notebook, panel, fold);
      const keep = async () => {
        await nextFrame();
        for (const [i, one] of [owner, notebook, panel].entries()) {
          await nextFrame(); // a second handle that is moved in the same frame resets the first one
          const edge = leftEdge(one);
          if (edge) panel.parent.layout.moveHandle(edge, lefts[i] - edge.offsetWidth, 0);
        }
      };
      keep();
    });
    tracker.currentChanged.connect((_, notebook) => {
      const panel = panels.get(notebook);
      if (stowed.has(panel)) unstow(notebook, panel);
      else if (panel?.isAttached && !panel.isVisible) panel.parent.selectWidget(panel);
      // JupyterLab shows a notebook that was opened a moment after it has become the current one.
      requestAnimationFrame(() => stow(tracker.currentWidget));
    });
  }

  /** Fold the file browser once, when the first notebook of a narrow or enlarged page opens. */
  function foldInNarrowWindow(app, tracker) {
    let isDone = false; // later it is the user's choice
    const fold = (notebook) => {
      if (isDone || !notebook || window.innerWidth >= NARROW_WINDOW) return;
      isDone = true;
      app.restored.then(() => app.shell.leftCollapsed || app.shell.collapseLeft());
    };
    fold(tracker.currentWidget);
    tracker.currentChanged.connect((_, notebook) => fold(notebook));
  }

  async function createPlugin() {
    const [{ IRenderMimeRegistry }, { INotebookTracker }, base] = await Promise.all(
      ["@jupyterlab/rendermime", "@jupyterlab/notebook", "@jupyter-widgets/base"].map(shared),
    );
    return {
      id: "course-lib:saved-outputs",
      description: "Shows what widgets showed before their kernel ended.",
      autoStart: true,
      requires: [IRenderMimeRegistry, INotebookTracker, base.IJupyterWidgetRegistry],
      activate: (app, rendermime, tracker) => {
        addStyles();
        const showEnded = showSavedWithoutWidget(app, rendermime, tracker);
        showSavedIfUntrusted(app, rendermime, tracker);
        arrangePanels(app, tracker);
        foldInNarrowWindow(app, tracker);
        const watch = (panel) => {
          queueSaves(panel.context);
          panel.context.saveState.connect((_, state) => state === "started" && savePictures(panel));
          const { sessionContext } = panel;
          let kernelSession = ""; // of the kernel's process
          sessionContext.iopubMessage.connect((_, { header }) => {
            // At a restart in another window, the old process reports its end, unless it is killed. JupyterLab's server
            // connects to the new one a moment later, and the first messages, or all, may be lost.
            const isNew = kernelSession && header.session !== kernelSession;
            if (isNew || header.msg_type === "shutdown_reply") sessionContext.statusChanged.emit("restarting");
            kernelSession = header.session;
            // A cell starts: what it changes belongs to its own picture.
            if (header.msg_type === "execute_input") savePictures(panel);
          });
          sessionContext.statusChanged.connect((_, status) => ENDED_STATUSES.includes(status) && showEnded(panel));
          const listen = (kernel) =>
            kernel?.registerCommTarget(IDENTITY_TARGET, (_, { content }) => updateIdentity(tracker, content.data));
          listen(sessionContext.session?.kernel);
          sessionContext.kernelChanged.connect((_, { newValue }) => listen(newValue));
          // A hub that culls an idle kernel ends its session, too.
          sessionContext.sessionChanged.connect((_, { newValue }) => newValue || showEnded(panel));
        };
        tracker.forEach(watch);
        tracker.widgetAdded.connect((_, panel) => watch(panel));
      },
    };
  }

  globalThis._JUPYTERLAB ??= {};
  globalThis._JUPYTERLAB["course-lib"] = {
    init: (sharedModules) => {
      scope = sharedModules;
    },
    get: async () => {
      const plugin = await createPlugin();
      return () => ({ __esModule: true, default: plugin });
    },
  };
})();
