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
    /** @type {number | null} pixels per metre, without perspective */
    this.scale = null;
  }

  /** @param {any} camera as Python describes it */
  look(camera) {
    this.eye.fromArray(camera.eye);
    this.target.fromArray(camera.target);
    this.up.fromArray(camera.up);
    this.fov = (camera.vertical_fov * 180) / Math.PI;
    this.near = camera.near;
    this.scale = camera.orthographic_scale;
  }

  /**
   * @param {number} width of the picture, in the pixels that `scale` counts
   * @param {number} height
   * @returns {any} a three.js camera
   */
  camera(width, height) {
    let camera;
    if (this.scale) {
      const [x, y] = [width / this.scale / 2, height / this.scale / 2];
      camera = new THREE.OrthographicCamera(-x, x, y, -y, -FAR, FAR);
    } else camera = new THREE.PerspectiveCamera(this.fov, width / height, this.near, FAR);
    camera.up.copy(this.up);
    camera.position.copy(this.eye);
    camera.lookAt(this.target);
    return camera;
  }

  /**
   * Turn around the target.
   * @param {number} left [rad]
   * @param {number} over [rad]
   */
  rotate(left, over) {
    const offset = this.eye.clone().sub(this.target);
    const distance = offset.length();
    const flat = Math.hypot(offset.x, offset.y) < 1e-3 * distance; // seen from above, `up` tells the heading
    const yaw = (flat ? Math.atan2(-this.up.y, -this.up.x) : Math.atan2(offset.y, offset.x)) - left;
    const pitch = Math.asin(offset.z / distance) + (this.scale ? 0 : over);
    const held = Math.max(-LIMIT, Math.min(LIMIT, pitch));
    const ahead = new THREE.Vector3(Math.cos(yaw) * Math.cos(held), Math.sin(yaw) * Math.cos(held), Math.sin(held));
    this.eye.copy(this.target).addScaledVector(ahead, distance);
    this.up.set(0, 0, 1);
  }

  /**
   * Move along the picture.
   * @param {number} right in heights of the picture
   * @param {number} down
   * @param {number} height in pixels
   */
  pan(right, down, height) {
    const camera = this.camera(1, 1);
    camera.updateMatrixWorld();
    const span = this.scale
      ? height / this.scale
      : 2 * this.eye.distanceTo(this.target) * Math.tan((this.fov * Math.PI) / 360);
    for (const [column, amount] of [[0, -right], [1, down]]) {
      const step = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, column).multiplyScalar(amount * span);
      this.eye.add(step);
      this.target.add(step);
    }
  }

  /** @param {number} factor of the distance */
  zoom(factor) {
    if (this.scale) this.scale /= factor;
    else this.eye.sub(this.target).multiplyScalar(factor).clampLength(0.02, FAR / 2).add(this.target);
  }
}
