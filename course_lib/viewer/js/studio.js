/* global THREE */
import { SHADOW, studio } from "./materials.js";

// The look "Studio": a light ground, the sun with a soft shadow, and a sky that is brighter than the ground, so that
// downward faces are darker. A weak light beside the camera distinguishes the sides in the shade. The grid fades in the
// distance. Labels have a plate and a limited size. RViz's look has none of this. A shadow map is reused while only the
// camera moves, and is rendered again only for fine pictures: coarse pictures of a moving robot, as drawn by software, have no shadow.

const GROUND = [233, 236, 241]; // RGB of the background, instead of RViz's default dark gray
const LIGHT = 128; // the darkest channel of a background that is light
const RVIZ_GREY = [48, 48, 48].join();
const SUN = new THREE.Vector3(0.3, 0.75, 1.1).normalize(); // direction to it, in the fixed frame
const MAP = 1024; // [px] side of the shadow map
const COARSE = 3; // [px] see Quality: in coarser pictures no shadow map is made
const FAINT = 77; // alpha in 0..255 below which an object casts no shadow
const SOFT = 0.03; // largest width of the edge of a shadow, as a fraction of the shadow map
const FARTHEST = 40; // [m] from the middle of the scene
const LETTERS = [8, 10]; // [px] range of the height of a label's capital letters, on a screen of usual density
const FADED = 8; // [m] minimum distance from the middle at which thin lines, like those of the grid, have faded
const CASTERS = 1; // the layer of the objects that cast a shadow

/** @param {any} mesh that casts a shadow, unless it is nearly transparent */
export function castsShadow(mesh) {
  if (mesh.geometry.attributes.tint.array[3] >= FAINT) mesh.layers.enable(CASTERS);
  return mesh;
}

/** @param {import("./mirror.js").Mirror} mirror @returns {number[]} RGB, 0 to 255 */
export const backgroundOf = ({ background, style }) =>
  style === "Studio" && background.join() === RVIZ_GREY ? GROUND : background;

/** @type {{engine: any, target: any, mirror: any, version: number, middle: any, radius: number, low: number} | null} */
let map = null;
/** @type {any} the light of the ground, which everything covers, and the shadow, which also falls on maps */
let floor = null;
const paintDepth = new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking, side: THREE.DoubleSide });

/**
 * Prepare the look of the next pictures of a scene.
 * @param {any} engine a three.js renderer @param {import("./mirror.js").Mirror} mirror @param {import("./quality.js").Quality} quality
 */
export function setUp(engine, mirror, quality) {
  studio.isStudio.value = mirror.style === "Studio";
  studio.isLight.value = studio.isStudio.value && Math.min(...backgroundOf(mirror)) > LIGHT;
  if (!studio.isStudio.value) return;
  studio.letters.value.fromArray(LETTERS).multiplyScalar(Math.min(window.devicePixelRatio, 2));
  const isKept = map?.engine === engine && map?.mirror === mirror && map?.version === mirror.version;
  if (!isKept && quality.cell <= COARSE) drawMap(engine, mirror);
  const isValid = isKept || quality.cell <= COARSE;
  studio.taps.value = !isValid || !map?.radius ? 0 : quality.cell ? 1 : 8;
  studio.soft.value = quality.cell ? 0 : SOFT;
}

/** @param {any} engine @param {import("./mirror.js").Mirror} mirror */
function drawMap(engine, mirror) {
  const filters = { minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter };
  const target = map && map.engine === engine ? map.target : new THREE.WebGLRenderTarget(MAP, MAP, filters);
  const bounds = new THREE.Box3();
  const casters = new THREE.Layers();
  casters.set(CASTERS);
  mirror.scene.updateMatrixWorld();
  mirror.scene.traverseVisible((/** @type {any} */ object) => {
    if (!object.layers.test(casters)) return;
    object.geometry.boundingBox ?? object.geometry.computeBoundingBox();
    const box = object.geometry.boundingBox.clone().applyMatrix4(object.matrixWorld);
    if (box.min.length() < FARTHEST && box.max.length() < FARTHEST) bounds.union(box);
  });
  const { center, radius } = bounds.getBoundingSphere(new THREE.Sphere());
  const hasCasters = !bounds.isEmpty();
  map = { engine, target, mirror, version: mirror.version, middle: center, radius: hasCasters ? radius : 0, low: Math.min(bounds.min.z, 0) };
  if (!hasCasters) return;
  const camera = new THREE.OrthographicCamera(-radius, radius, radius, -radius, 0, 4 * radius);
  camera.layers.set(CASTERS);
  camera.position.copy(center).addScaledVector(SUN, 2 * radius);
  camera.up.set(0, 1, 0);
  camera.lookAt(center);
  camera.updateMatrixWorld();
  mirror.scene.overrideMaterial = paintDepth;
  engine.setRenderTarget(target);
  engine.setClearColor(new THREE.Color(1, 1, 1), 1);
  engine.render(mirror.scene, camera);
  engine.setRenderTarget(null);
  mirror.scene.overrideMaterial = null;
  const half = new THREE.Matrix4().set(0.5, 0, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0, 1);
  studio.toShade.value.multiplyMatrices(half, camera.projectionMatrix).multiply(camera.matrixWorldInverse);
  studio.shade.value = target.texture;
}

/**
 * Draw the ground and the scene.
 * @param {import("./mirror.js").Mirror} mirror @param {any} camera @param {() => void} render
 */
export function onGround(mirror, camera, render) {
  if (!studio.isStudio.value) return render();
  studio.sun.value.copy(SUN).transformDirection(camera.matrixWorldInverse);
  studio.sky.value.set(0, 0, 1).transformDirection(camera.matrixWorldInverse);
  floor ??= createFloor();
  const isLight = backgroundOf(mirror) === GROUND;
  floor.children[0].visible = isLight;
  const reach = map?.mirror === mirror && map.radius ? map.radius : 1;
  floor.scale.setScalar(12 * Math.max(reach, 0.5));
  if (map?.mirror === mirror && map.radius) floor.position.set(map.middle.x, map.middle.y, map.low);
  studio.middle.value.set(floor.position.x, floor.position.y);
  studio.reach.value = Math.max(FADED, 6 * reach);
  mirror.scene.add(floor);
  render();
  mirror.scene.remove(floor);
}

function createFloor() {
  const layers = [floorMaterial("LIGHT"), floorMaterial("SHADE")].map((paint) => {
    const layer = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), paint);
    layer.renderOrder = -2; // before all other objects of its kind
    layer.raycast = () => {};
    return layer;
  });
  // The light is drawn with the opaque objects: it comes first.
  Object.assign(layers[0].material, { transparent: false, blending: THREE.CustomBlending, blendSrcAlpha: THREE.OneFactor });
  return new THREE.Group().add(...layers);
}

/** @param {"LIGHT" | "SHADE"} layer */
const floorMaterial = (layer) =>
  new THREE.ShaderMaterial({
    uniforms: studio,
    defines: { [layer]: "" },
    transparent: true,
    depthWrite: false,
    vertexShader: `
      uniform mat4 toShade;
      varying vec3 vShade;
      varying vec2 vUv;
      void main() {
        vUv = 2.0 * uv - 1.0;
        vec4 world = modelMatrix * vec4(position, 1.0);
        vShade = (toShade * world).xyz;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: `
      varying vec2 vUv;
      ${SHADOW}
      void main() {
        #ifdef LIGHT
          gl_FragColor = vec4(1.0, 1.0, 1.0, 0.85 * (1.0 - smoothstep(0.1, 1.0, length(vUv))));
        #else
          gl_FragColor = vec4(0.13, 0.16, 0.22, 0.42 * (1.0 - sunlight()));
        #endif
      }`,
  });
