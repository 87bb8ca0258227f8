/* global THREE, MeshCat */
import { buildLines, buildPoints, buildText } from "./billboards.js";
import { buildMesh, buildSolids, writeMatrix } from "./surfaces.js";
import { decode } from "./decode.js";

/** @type {Record<string, (description: any) => any>} */
const BUILDERS = { solids: buildSolids, mesh: buildMesh, lines: buildLines, points: buildPoints, text: buildText };

/** The page's copy of a scene: one three.js tree that all views of it look at. */
export class Mirror {
  constructor() {
    this.scene = new THREE.Scene();
    this.scene.userData.path = "";
    this.light = new THREE.DirectionalLight(0xffffff, 1); // for meshcat's own materials
    this.scene.add(this.light);
    /** @type {Map<string, any>} */
    this.nodes = new Map([["", this.scene]]);
    /** @type {Set<any>} */
    this.views = new Set();
    this.background = [48, 48, 48];
    /** @type {any} */
    this.camera = null;
    /** @type {string[]} */
    this.paths = [];
    /** @type {any[] | null} */
    this.moving = null;
    /** @type {any} */
    this.mixer = null;
  }

  /** @param {Uint8Array} bytes a batch of changes */
  apply(bytes) {
    const batch = decode(bytes);
    for (const command of batch.commands ?? []) this.obey(command);
    if (batch.paths) this.paths = batch.paths;
    if (batch.paths || batch.commands) this.moving = null;
    if (batch.matrices) this.place(batch.matrices);
    this.changed();
  }

  /** @param {Uint8Array} bytes a whole scene, in place of the one that is here */
  reset(bytes) {
    this.clear("");
    this.apply(bytes);
  }

  changed() {
    for (const view of this.views) view.invalidate();
  }

  /** @param {any} command */
  obey(command) {
    const { type, path } = command;
    if (type === "object") this.put(path, command.object);
    else if (type === "delete") this.clear(path);
    else if (type === "visible") this.node(path).visible = command.value;
    else if (type === "property") this.setProperty(this.node(path), command.name, command.value);
    else if (type === "background") this.background = command.color;
    else if (type === "camera") this.look(command);
    else if (type === "animation") this.animate(command.animations, command.options);
  }

  /**
   * @param {string} path
   * @returns {any} the node there, made if need be
   */
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
  place(matrices) {
    this.moving ??= this.paths.map((path) => this.node(path));
    this.moving.forEach((node, i) => {
      node.matrixAutoUpdate = false;
      writeMatrix(node.matrix.elements, 0, matrices, 12 * i);
      node.matrixWorldNeedsUpdate = true;
    });
  }

  /**
   * @param {string} path
   * @param {any} description
   */
  put(path, description) {
    const node = this.node(path);
    if (node.userData.object) this.drop(node.userData.object);
    const object = description.kind === "meshcat" ? this.load(description.json) : BUILDERS[description.kind](description);
    node.userData.object = object;
    node.add(object);
  }

  /**
   * @param {any} json an object of the meshcat package
   * @returns {any} a group that gets it, at once unless it has pictures
   */
  load(json) {
    const group = new THREE.Group();
    const host = {
      set_dirty: () => this.changed(),
      set_object: (/** @type {any} */ _path, /** @type {any} */ object) => {
        object.traverse((/** @type {any} */ part) => {
          for (const material of [part.material ?? []].flat()) material.specular?.set(0);
        });
        group.add(object);
      },
    };
    MeshCat.Viewer.prototype.set_object_from_json.call(host, [], json);
    return group;
  }

  /** @param {string} path removed with all below it */
  clear(path) {
    const node = this.nodes.get(path);
    if (!node) return;
    for (const child of [...node.children]) if (child !== this.light) this.drop(child);
    if (path !== "") {
      node.parent.remove(node);
      this.nodes.delete(path);
    } else this.mixer = null;
  }

  /** @param {any} top taken out of the tree, with its share of the graphics memory */
  drop(top) {
    top.parent?.remove(top);
    top.traverse((/** @type {any} */ object) => {
      if (object.userData.path) this.nodes.delete(object.userData.path);
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

  /**
   * @param {any} node
   * @param {string} name
   * @param {any} value
   */
  setProperty(node, name, value) {
    if (name === "color") {
      node.traverse((/** @type {any} */ part) => {
        part.geometry?.attributes.tint?.array.forEach((/** @type {number} */ _, /** @type {number} */ i, /** @type {any} */ all) => (all[i] = 255 * value[i % 4]));
        for (const material of [part.material ?? []].flat()) {
          material.color?.setRGB(value[0], value[1], value[2]);
          if (!material.isShaderMaterial) Object.assign(material, { opacity: value[3], transparent: value[3] < 1 });
        }
      });
    } else if (["position", "quaternion", "scale"].includes(name)) {
      node.matrix.decompose(node.position, node.quaternion, node.scale);
      node[name].fromArray(value);
      node.updateMatrix();
    } else node[name] = value;
  }

  /** @param {any} camera */
  look(camera) {
    this.camera = camera;
    for (const view of this.views) view.orbit.look(camera);
  }

  /**
   * Play clips, as meshcat's animator does.
   * @param {any[]} animations
   * @param {any} options
   */
  animate(animations, options = {}) {
    this.mixer = new THREE.AnimationMixer(this.scene);
    this.clock = new THREE.Clock();
    for (const { path, clip } of animations) {
      const node = this.node(path.split("/").filter(Boolean).join("/"));
      node.matrix.decompose(node.position, node.quaternion, node.scale);
      node.matrixAutoUpdate = true;
      const parsed = THREE.AnimationClip.parse(clip);
      parsed.uuid = THREE.MathUtils.generateUUID(); // meshcat gives none, and three.js tells clips apart by it
      const action = this.mixer.clipAction(parsed, node);
      action.clampWhenFinished = options.clampWhenFinished ?? true;
      action.setLoop(options.loopMode ?? THREE.LoopRepeat, options.repetitions ?? 1);
      if (options.play ?? true) action.play();
    }
  }

  /** @returns {boolean} whether anything moves by itself */
  tick() {
    if (!this.mixer) return false;
    this.mixer.update(this.clock.getDelta());
    return this.mixer._actions.some((/** @type {any} */ action) => action.isRunning());
  }
}
