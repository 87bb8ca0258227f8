/* global THREE, MeshCat */
import { buildLines, buildPoints, buildText } from "./billboards.js";
import { buildInset } from "./insets.js";
import { buildMesh, buildSheet, buildSolids, writeMatrix } from "./surfaces.js";

/** The page's copy of a scene: one three.js tree, which all its views draw. */
export class Mirror {
  constructor() {
    this.scene = new THREE.Scene();
    this.scene.userData.path = "";
    this.light = new THREE.DirectionalLight(0xffffff, 1); // for meshcat's own materials
    this.scene.add(this.light);
    this.nodes = new Map([["", this.scene]]);
    /** @type {Set<import("./view.js").View>} */
    this.views = new Set();
    /** @type {Set<any>} groups of the pictures in a corner of the views */
    this.insets = new Set();
    this.lastingMessage = ""; // a message that the views show until its condition has ended
    this.background = [48, 48, 48];
    this.style = "RViz"; // or "Studio"
    this.version = 0; // version of the contents, without the camera
    this.camera = null; // as Python describes it
    this.mixer = null;
    this.animation = null; // as meshcat describes it
    this.clock = new THREE.Clock();
    /** @type {any[]} */
    this.actions = [];
    /** @type {string[]} paths of the next matrices */
    this.paths = [];
    /** @type {any[] | null} */
    this.matrixNodes = null; // the nodes at these paths, or null until they are looked up
    /** @type {Record<string, (object: any) => any>} */
    this.builders = {
      solids: buildSolids,
      mesh: buildMesh,
      lines: buildLines,
      points: buildPoints,
      text: buildText,
      sheet: buildSheet,
      inset: buildInset,
      meshcat: (object) => this.loadMeshcatObject(object.json),
    };
    /** @type {Record<string, (command: any) => void>} */
    this.handlers = {
      object: ({ path, object }) => this.setObject(path, object),
      visible: ({ path, value }) => (this.node(path).visible = value),
      delete: ({ path }) => this.clear(path),
      background: ({ color, look }) => ([this.background, this.style] = [color, look ?? "RViz"]),
      camera: (camera) => this.setCamera(camera),
      animation: (animation) => this.animate(animation),
    };
  }

  /** @param {any} batch of changes, decoded */
  apply(batch) {
    /** @type {Error | null} */
    let firstError = null;
    for (const command of batch.commands ?? []) {
      try {
        this.handlers[command.type](command);
      } catch (error) {
        firstError ??= new Error(`${command.path ?? command.type}: ${error}`); // the other changes are still applied
      }
    }
    if (batch.paths) this.paths = batch.paths;
    if (batch.paths || batch.commands) this.matrixNodes = null;
    if (batch.matrices) this.setMatrices(batch.matrices);
    this.version++;
    this.invalidateViews();
    if (firstError) throw firstError;
  }

  /** @param {any} batch a whole decoded scene, which replaces the current one */
  reset(batch) {
    this.clear("");
    this.apply(batch);
  }

  /** @returns {any} the batch that creates this scene */
  snapshot() {
    const { background: color, style: look, camera, animation } = this;
    const style = look === "RViz" ? {} : { look };
    const commands = [{ type: "background", color, ...style }, camera, animation].filter(Boolean);
    /** @type {string[]} */
    const paths = [];
    /** @type {number[]} */
    const matrices = [];
    for (const [path, node] of this.nodes) {
      const object = node.userData.object?.userData.description;
      if (object) commands.push({ type: "object", path, object });
      if (!node.visible) commands.push({ type: "visible", path, value: false });
      if (path) paths.push(path);
      if (path) for (let i = 0; i < 16; i++) if (i % 4 < 3) matrices.push(node.matrix.elements[i]);
    }
    return { commands, paths, matrices: new Float32Array(matrices) };
  }

  invalidateViews() {
    for (const view of this.views) view.invalidate();
  }

  /** @param {string} path @returns {any} the node at the path, created if it does not exist */
  node(path) {
    let node = this.nodes.get(path);
    if (!node) {
      node = new THREE.Group();
      node.matrixAutoUpdate = false;
      node.userData.path = path;
      this.nodes.set(path, node);
      this.node(path.slice(0, Math.max(path.lastIndexOf("/"), 0))).add(node);
    }
    return node;
  }

  /** @param {Float32Array} matrices twelve numbers for each of the paths */
  setMatrices(matrices) {
    this.matrixNodes ??= this.paths.map((path) => this.node(path));
    this.matrixNodes.forEach((node, i) => {
      node.matrixAutoUpdate = false;
      writeMatrix(node.matrix.elements, 0, matrices, 12 * i);
      node.matrixWorldNeedsUpdate = true;
    });
  }

  /** @param {string} path @param {any} description of the object for this node */
  setObject(path, description) {
    const node = this.removeObject(path);
    node.userData.object = this.builders[description.kind](description);
    node.userData.object.userData.description = description;
    node.add(node.userData.object);
    if (node.userData.object.userData.inset) this.insets.add(node.userData.object);
  }

  /** @param {string} path @returns {any} the node at the path, without its object */
  removeObject(path) {
    const node = this.node(path);
    if (node.userData.object) this.dispose(node.userData.object);
    node.userData.object = null;
    return node;
  }

  /** @param {any} json an object of meshcat @returns {any} a group to which it is added once its images are loaded */
  loadMeshcatObject(json) {
    const group = new THREE.Group();
    const host = {
      set_dirty: () => this.invalidateViews(),
      set_object: (/** @type {string[]} */ _, /** @type {any} */ object) => {
        for (const material of [object.material ?? []].flat()) material.specular?.set(0);
        group.add(object);
      },
    };
    MeshCat.Viewer.prototype.set_object_from_json.call(host, [], json);
    return group;
  }

  /** @param {string} path removed with all nodes below it */
  clear(path) {
    const node = this.nodes.get(path);
    if (node !== this.scene) return node && this.dispose(node);
    for (const child of [...this.scene.children]) if (child !== this.light) this.dispose(child);
    this.mixer = this.animation = null;
  }

  /** @param {any} top removed from the tree, releasing its graphics memory */
  dispose(top) {
    top.parent?.remove(top);
    top.traverse((/** @type {any} */ object) => {
      this.nodes.delete(object.userData.path);
      this.insets.delete(object);
      object.geometry?.dispose();
      if (object.isInstancedMesh) object.dispose();
      object.userData.mask?.dispose();
      for (const material of [object.material ?? []].flat()) {
        if (material.isShaderMaterial) continue; // shared
        material.map?.dispose();
        material.dispose();
      }
    });
  }

  /** @param {any} camera as Python describes it */
  setCamera(camera) {
    this.camera = camera;
    for (const view of this.views) view.setCamera(camera);
  }

  /** @param {any} animation clips that are played as meshcat does */
  animate(animation) {
    this.animation = animation;
    const { animations, options = {} } = animation;
    this.mixer = new THREE.AnimationMixer(this.scene);
    this.clock.start();
    this.actions = animations.map((/** @type {any} */ { path, clip }) => {
      const node = this.node(path.split("/").filter(Boolean).join("/"));
      node.matrix.decompose(node.position, node.quaternion, node.scale);
      node.matrixAutoUpdate = true;
      const parsed = THREE.AnimationClip.parse(clip);
      parsed.uuid = THREE.MathUtils.generateUUID(); // clips need a unique id, which meshcat does not provide
      const action = this.mixer.clipAction(parsed, node);
      action.clampWhenFinished = options.clampWhenFinished ?? true;
      action.setLoop(options.loopMode ?? THREE.LoopRepeat, options.repetitions ?? 1);
      return (options.play ?? true) ? action.play() : action;
    });
  }

  /** @returns {boolean} whether an animation is playing */
  advanceAnimation() {
    if (!this.mixer) return false;
    this.version++;
    this.mixer.update(this.clock.getDelta());
    return this.actions.some((action) => action.isRunning());
  }
}
