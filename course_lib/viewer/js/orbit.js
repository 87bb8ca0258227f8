/* global THREE */

const LIMIT = Math.PI / 2 - 0.001; // [rad] RViz's limit of the pitch
const FAR = 1000; // [m]

/** Where a view looks from, turned by hand around a point as in RViz's Orbit view. */
export class Orbit {
  constructor() {
    this.eye = new THREE.Vector3(5, 5, 7);
    this.target = new THREE.Vector3();
    this.up = new THREE.Vector3(0, 0, 1);
    this.fov = 45; // [deg] vertical
    this.near = 0.01; // [m]
    this.scale = 0; // pixels per metre, without perspective
    this.inPlace = false; // turns around the eye, as RViz's FPS view
    this.shift = [0, 0]; // see Python's Camera
    this.far = FAR; // [m]
  }

  /** @param {any} camera as Python describes it */
  look(camera) {
    this.eye.fromArray(camera.eye);
    this.target.fromArray(camera.target);
    this.up.fromArray(camera.up);
    this.fov = (camera.vertical_fov * 180) / Math.PI;
    this.near = camera.near;
    this.scale = camera.orthographic_scale ?? 0;
    this.shift = camera.shift;
    this.far = camera.far;
  }

  /** @param {number} width in the pixels of `scale` @param {number} height @returns {any} for three.js */
  camera(width, height) {
    let camera;
    if (this.scale) {
      const [x, y] = [width / this.scale / 2, height / this.scale / 2];
      camera = new THREE.OrthographicCamera(-x, x, y, -y, -FAR, FAR);
    } else camera = new THREE.PerspectiveCamera(this.fov, width / height, this.near, this.far);
    const [right, down] = this.shift.map((part) => -part * height);
    if (right || down) camera.setViewOffset(width, height, right, down, width, height);
    camera.up.copy(this.up);
    camera.position.copy(this.eye);
    camera.lookAt(this.target);
    camera.updateMatrixWorld();
    return camera;
  }

  /** Turn around the target. @param {number} left [rad] @param {number} over [rad] */
  rotate(left, over) {
    const offset = this.eye.clone().sub(this.target);
    const distance = offset.length();
    const above = Math.hypot(offset.x, offset.y) < 1e-3 * distance; // then `up` tells the heading
    const yaw = (above ? Math.atan2(-this.up.y, -this.up.x) : Math.atan2(offset.y, offset.x)) - left;
    const pitch = Math.asin(offset.z / distance) + (this.scale ? 0 : over);
    const held = Math.max(-LIMIT, Math.min(LIMIT, pitch));
    const [flat, up] = [Math.cos(held), Math.sin(held)];
    offset.set(Math.cos(yaw) * flat, Math.sin(yaw) * flat, up).multiplyScalar(distance);
    if (this.inPlace) this.target.subVectors(this.eye, offset);
    else this.eye.addVectors(this.target, offset);
    this.up.set(0, 0, 1);
  }

  /** Move along the picture. @param {number} dx in pixels @param {number} dy @param {number} height of it */
  pan(dx, dy, height) {
    const { matrixWorld } = this.camera(1, 1);
    const far = 2 * this.eye.distanceTo(this.target) * Math.tan((this.fov * Math.PI) / 360);
    const unit = this.scale ? 1 / this.scale : far / height; // [m] per pixel
    const step = new THREE.Vector3(-dx * unit, dy * unit, 0).transformDirection(matrixWorld);
    step.multiplyScalar(Math.hypot(dx, dy) * unit);
    this.eye.add(step);
    this.target.add(step);
  }

  /** @param {number[]} point [m] that is looked at and turned around */
  lookAt(point) {
    const to = new THREE.Vector3(...point);
    if (this.scale) this.eye.add(to.clone().sub(this.target).setZ(0));
    this.target.copy(to);
  }

  /** @param {number} factor of the distance */
  zoom(factor) {
    if (this.scale) this.scale /= factor;
    else if (this.inPlace) {
      const step = this.eye.clone().sub(this.target).normalize().multiplyScalar(10 * (factor - 1)); // [m]
      this.eye.add(step);
      this.target.add(step);
    } else this.eye.sub(this.target).multiplyScalar(factor).clampLength(0.02, FAR / 2).add(this.target);
  }
}
