/* global THREE */

const LIMIT = Math.PI / 2 - 0.001; // [rad] RViz's limit of the pitch
const FAR = 100_000; // [m] as in RViz
const DEPTH = 1000; // [m] before and behind a camera without perspective
const FARTHEST_FOCUS = 50_000; // [m] of the focal point
// A view beside the notebook is narrow and tall. It shows at least as much from left to right as a picture of this aspect
// ratio in a cell, or, without perspective, as one of this width.
const ASPECT = 1.2;
const WIDTH = 600; // [px]
const MAX_WIDENING = 1.8; // maximum magnification of the opening angle's tangent, because wide angles distort

/** The camera pose of a view, turned by hand around a point as in RViz's Orbit view. */
export class Orbit {
  constructor() {
    this.eye = new THREE.Vector3(5, 5, 7);
    this.target = new THREE.Vector3();
    this.up = new THREE.Vector3(0, 0, 1);
    this.fov = 45; // [deg] vertical
    this.near = 0.01; // [m]
    this.scale = 0; // pixels per metre, without perspective
    this.inPlace = false; // rotates around the eye, like RViz's FPS view
    this.aligned = false; // `up` belongs to a frame, as in RViz's FrameAligned view
    this.locked = false; // cannot be turned by hand
    this.lift = 0; // upward shift of RViz's XYOrbit view in the image, as a fraction of the distance
    this.ground = 0; // [m] height of the plane that XYOrbit moves on
    this.focalSize = 0; // [m] diameter of a disc at the focal point, or 0; see Python's DragRules
    this.focalFixed = true;
    this.shift = [0, 0]; // see Python's Camera
    this.far = FAR; // [m]
    this.isTall = false; // opens wider where it is narrow, see ASPECT
  }

  /** @param {any} camera as Python describes it */
  setCamera(camera) {
    this.eye.fromArray(camera.eye);
    this.target.fromArray(camera.target);
    this.up.fromArray(camera.up);
    this.fov = (camera.vertical_fov * 180) / Math.PI;
    this.near = camera.near;
    this.scale = camera.orthographic_scale ?? 0;
    this.shift = camera.shift;
    this.far = camera.far;
  }

  /** @returns {any} the camera pose in the fields of Python's orders */
  pose() {
    const { eye, target, up, scale } = this;
    return { eye: eye.toArray(), target: target.toArray(), up: up.toArray(), scale };
  }

  /** @param {number} width of the picture in pixels @param {number} height @returns {number} size of a pixel [m] at a distance of 1 m, or anywhere without perspective */
  pixel(width, height) {
    const { slope, scale } = this.lens(width, height);
    return scale ? 1 / scale : (2 * slope) / height;
  }

  /** @param {number} width of the picture in pixels @param {number} height @returns {{slope: number, scale: number}} the tangent of half the opening angle; pixels per metre, or 0 */
  lens(width, height) {
    const slope = Math.tan((this.fov * Math.PI) / 360);
    if (!this.isTall) return { slope, scale: this.scale };
    const wider = Math.min(Math.max((ASPECT * height) / width, 1), MAX_WIDENING);
    return { slope: slope * wider, scale: this.scale * Math.min(width / WIDTH, 1) };
  }

  /** @param {number} width in the pixels of `scale` @param {number} height @returns {any} for three.js */
  camera(width, height) {
    let camera;
    const { slope, scale } = this.lens(width, height);
    if (scale) {
      const [x, y] = [width / scale / 2, height / scale / 2];
      camera = new THREE.OrthographicCamera(-x, x, y, -y, -DEPTH, DEPTH);
    } else camera = new THREE.PerspectiveCamera((Math.atan(slope) * 360) / Math.PI, width / height, this.near, this.far);
    const [right, down] = this.shift.map((part) => -part * height);
    if (right || down) camera.setViewOffset(width, height, right, down, width, height);
    camera.up.copy(this.up);
    camera.position.copy(this.eye);
    camera.lookAt(this.target);
    camera.updateMatrixWorld();
    return camera;
  }

  /** @param {number} left [rad] to turn around the target @param {number} over [rad] */
  rotate(left, over) {
    const up = new THREE.Vector3(0, 0, 1);
    if (this.scale) {
      this.up.applyAxisAngle(up, left);
      return;
    }
    this.raise(-1);
    const axis = this.aligned ? this.up.clone() : new THREE.Vector3(0, 0, this.up.z < -0.5 ? -1 : 1);
    const level = new THREE.Quaternion().setFromUnitVectors(axis, up);
    const offset = this.eye.clone().sub(this.target).applyQuaternion(level);
    const distance = offset.length();
    const above = Math.hypot(offset.x, offset.y) < 1e-4 * distance; // the heading then follows from `up`
    const yaw = (above ? Math.atan2(-this.up.y, -this.up.x) : Math.atan2(offset.y, offset.x)) - left;
    const pitch = Math.max(-LIMIT, Math.min(LIMIT, Math.asin(offset.z / distance) + over));
    const [flat, high] = [Math.cos(pitch), Math.sin(pitch)];
    offset.set(Math.cos(yaw) * flat, Math.sin(yaw) * flat, high).multiplyScalar(distance);
    offset.applyQuaternion(level.invert());
    if (this.inPlace) this.target.subVectors(this.eye, offset);
    else this.eye.addVectors(this.target, offset);
    this.up.copy(axis);
    this.raise(1);
  }

  /** @param {number} sign 1 applies the upward shift of RViz's XYOrbit, -1 removes it */
  raise(sign) {
    if (!this.lift) return;
    const away = this.eye.clone().sub(this.target);
    const step = this.up.clone().projectOnPlane(away.clone().normalize());
    this.shiftBy(step.setLength(sign * this.lift * away.length()));
  }

  /** @returns {boolean} whether Shift and the right button move ahead; in RViz's other views they zoom */
  get hasDolly() {
    return !this.scale && !this.inPlace && !this.lift;
  }

  /** @returns {{point: any, distance: number}} the focal point and its distance, [m] */
  focalPoint() {
    const lowered = Object.assign(new Orbit(), this, { eye: this.eye.clone(), target: this.target.clone() });
    lowered.raise(-1);
    return { point: lowered.target, distance: lowered.eye.distanceTo(lowered.target) };
  }

  /** @param {any} step [m] for eye and target */
  shiftBy(step) {
    this.eye.add(step);
    this.target.add(step);
  }

  /**
   * Move parallel to the image, or on the ground.
   * @param {number} dx in pixels @param {number} dy @param {{clientWidth: number, clientHeight: number}} box
   * @param {number[]} at the pointer's position in the box, in pixels
   */
  pan(dx, dy, { clientWidth: width, clientHeight: height }, at = [width / 2, height / 2]) {
    const camera = this.camera(width, height);
    if (this.lift) {
      const [from, to] = [[at[0] - dx, at[1] - dy], at].map(([x, y]) =>
        this.onGround(camera, (2 * x) / width - 1, 1 - (2 * y) / height),
      );
      if (from && to) this.shiftBy(from.sub(to).clampLength(0, 1)); // [m], RViz's limit near the horizon
      return;
    }
    const distance = this.scale ? 1 : this.eye.distanceTo(this.target);
    const unit = this.inPlace ? -0.01 : distance * this.pixel(width, height); // [m] per pixel
    this.shiftBy(new THREE.Vector3(-dx * unit, dy * unit, 0).applyQuaternion(camera.quaternion));
  }

  /** @param {any} camera @param {number} x -1..1 in the picture @param {number} y @returns {any} [m] or null */
  onGround(camera, x, y) {
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(x, y), camera);
    const { origin, direction } = caster.ray;
    const distance = (this.ground - origin.z) / direction.z;
    return distance > 0 && Number.isFinite(distance) ? origin.clone().addScaledVector(direction, distance) : null;
  }

  /** @param {number} part of the distance to move backward, together with the focal point */
  dolly(part) {
    this.shiftBy(this.eye.clone().sub(this.target).multiplyScalar(part));
  }

  /** @param {number[]} point the new focal point [m] */
  lookAt(point) {
    const to = new THREE.Vector3(...point);
    if (to.distanceTo(this.eye) < this.near) return; // a line through the eye gives no direction
    if (this.scale) this.eye.add(to.clone().sub(this.target).setZ(0));
    if (this.lift) to.z = this.ground;
    this.target.copy(to);
    if (this.inPlace) this.target.sub(this.eye).normalize().add(this.eye); // always 1 m ahead
    this.raise(1);
  }

  /** @param {number} factor of the distance */
  zoom(factor) {
    if (this.scale) this.scale /= factor;
    else if (this.inPlace) this.dolly(10 * (factor - 1)); // [m]: the target is 1 m ahead
    else {
      this.raise(-1);
      this.eye.sub(this.target).multiplyScalar(factor).clampLength(0.02, FARTHEST_FOCUS).add(this.target);
      this.raise(1);
    }
  }
}
