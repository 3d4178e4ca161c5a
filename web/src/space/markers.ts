import {
  BufferGeometry,
  Color,
  Float32BufferAttribute,
  Points,
  ShaderMaterial,
  Uint8BufferAttribute,
  Vector3,
  type BufferAttribute,
} from "three";
import { colour, currentTheme, onThemeChange } from "../theme";

/** Shapes, distinct without colours. */
export const kDisc = 0;
export const kDiamond = 1;
export const kCross = 2;

// Grey of black and of white points, distinct from the background; 0 to 1.
const kGreysOnDark = [0.35, 1];
const kGreysOnLight = [0, 0.72];

const kUnlimited = 1e30; // metres

const kVertexShader = `
  attribute float kind;
  attribute float grey;
  uniform float size;
  uniform vec2 greys; // of black and white points; equal: points have the colour of their kind
  uniform vec3 colours[3];
  uniform float forms[3];
  uniform vec3 low; // box in the view frame, outside which points are far
  uniform vec3 high;
  varying vec3 colour;
  varying float form;
  varying float isFar;
  void main() {
    int index = int(kind + 0.5);
    colour = greys.x == greys.y ? colours[index] : vec3(mix(greys.x, greys.y, grey));
    form = forms[index];
    vec3 placed = (modelMatrix * vec4(position, 1.0)).xyz;
    isFar = any(lessThan(placed, low)) || any(greaterThan(placed, high)) ? 1.0 : 0.0;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_PointSize = isFar > 0.5 ? 0.6 * size : size;
  }`;

const kFragmentShader = `
  uniform float opacity;
  varying vec3 colour;
  varying float form;
  varying float isFar;
  void main() {
    if (isFar > 0.5 && mod(floor(gl_FragCoord.x) + floor(gl_FragCoord.y), 2.0) > 0.5) discard;
    vec2 p = abs(2.0 * gl_PointCoord - 1.0);
    bool inside = form < 0.5 ? dot(p, p) <= 1.0 : form < 1.5 ? p.x + p.y <= 1.0 : abs(p.x - p.y) < 0.35;
    if (!inside) discard;
    gl_FragColor = vec4(colour, opacity);
  }`;

/** Appearance of a kind of markers: name of a colour in style.css, and a shape. */
export interface MarkerKind {
  colour: string;
  form: number;
}

// Markers drawn at once while the view moves.
const kCoarseMarkers = 100_000;

/** Values of each marker in another order, in which the first markers are spread over all. stride: values of a marker. */
function spread<Values extends Float32Array | Uint8Array | number[]>(values: Values, stride: number): Values {
  const count = values.length / stride;
  if (count <= kCoarseMarkers) return values;
  const kept = values.slice() as Values;
  const steps = Math.ceil(count / kCoarseMarkers);
  let to = 0;
  for (let first = 0; first < steps; ++first) {
    for (let from = first; from < count; from += steps) {
      for (let i = 0; i < stride; ++i) kept[to++] = values[stride * from + i];
    }
  }
  return kept;
}

/** Points drawn as markers of constant size in pixels, of up to three kinds. */
export class Markers {
  readonly points: Points<BufferGeometry, ShaderMaterial>;
  readonly #kinds: MarkerKind[];
  #isGrey = false;

  constructor(kinds: MarkerKind[], pixels: number, opacity = 1) {
    this.#kinds = kinds;
    const forms = [0, 1, 2].map((i) => kinds[Math.min(i, kinds.length - 1)].form);
    const material = new ShaderMaterial({
      vertexShader: kVertexShader,
      fragmentShader: kFragmentShader,
      transparent: opacity < 1,
      uniforms: {
        size: { value: pixels * Math.min(window.devicePixelRatio, 2) },
        opacity: { value: opacity },
        colours: { value: [new Color(), new Color(), new Color()] },
        forms: { value: forms },
        greys: { value: [0, 0] },
        low: { value: new Vector3().setScalar(-kUnlimited) },
        high: { value: new Vector3().setScalar(kUnlimited) },
      },
    });
    this.points = new Points(new BufferGeometry(), material);
    this.points.frustumCulled = false;
    this.#recolour();
    onThemeChange(() => this.#recolour());
  }

  /** Replaces all markers. positions: x, y, z each; kinds: index of the kind each, by default 0. */
  set(positions: Float32Array | number[], kinds?: Uint8Array | number[]): void {
    const count = positions.length / 3;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(spread(positions, 3), 3));
    geometry.setAttribute("kind", new Float32BufferAttribute(spread(kinds ?? new Float32Array(count), 1), 1));
    this.points.geometry.dispose();
    this.points.geometry = geometry;
  }

  /** Draws each marker in its grey value, or in the colour of its kind without values. */
  setGreys(greys: Uint8Array | null): void {
    this.#isGrey = greys !== null;
    if (greys) this.points.geometry.setAttribute("grey", new Uint8BufferAttribute(spread(greys, 1), 1, true));
    this.#recolour();
  }

  /** Draws all markers, or of many only some, spread over all. */
  setDetail(isFull: boolean): void {
    this.limit(isFull ? Infinity : kCoarseMarkers);
  }

  /** Replaces all markers by reserved ones that are not drawn. */
  reserve(count: number): void {
    this.set(new Float32Array(3 * count));
    this.limit(0);
  }

  /** Changes a reserved marker. */
  put(index: number, position: [number, number, number], kind: number): void {
    const { position: positions, kind: kinds } = this.points.geometry.attributes as Record<string, BufferAttribute>;
    positions.setXYZ(index, ...position);
    positions.addUpdateRange(3 * index, 3);
    positions.needsUpdate = true;
    kinds.setX(index, kind);
    kinds.addUpdateRange(index, 1);
    kinds.needsUpdate = true;
  }

  /** Draws the first markers only. */
  limit(count: number): void {
    this.points.geometry.setDrawRange(0, count);
  }

  #recolour(): void {
    const greys = currentTheme() === "dark" ? kGreysOnDark : kGreysOnLight;
    this.points.material.uniforms.greys.value = this.#isGrey ? greys : [0, 0];
    this.points.material.uniforms.colours.value.forEach((value: Color, i: number) => {
      const kind = this.#kinds[Math.min(i, this.#kinds.length - 1)];
      // The shader writes colours without conversion from linear light.
      value.set(colour(kind.colour)).convertLinearToSRGB();
    });
  }
}
