import {
  Box3,
  Group,
  Matrix4,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
  type Object3D,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { onceAFrame } from "../dom";
import { onThemeChange } from "../theme";

const kUp = new Vector3(0, 0, 1);
const kOrbitStep = 0.12; // radians per key press
const kZoomStep = 1.15;
const kClick = 4; // largest motion of the pointer during a click, pixels
const kTap = 10; // of a finger
const kSettling = 200; // ms without motion before all details are drawn

/** Position on the canvas, CSS pixels. */
export interface Click {
  x: number;
  y: number;
  isTouch: boolean;
}

/** Whether WebGL is rendered in software, where antialiasing takes most of the time. */
function isDrawnInSoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const names = context?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? String(context?.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

/** 3D view, redrawn only after changes. */
export class Stage {
  readonly camera = new PerspectiveCamera(50, 1, 0.05, 5000);
  /** Objects in the view frame. */
  readonly room = new Group();
  /** Objects in the map frame. */
  readonly map = new Group();
  readonly canvas: HTMLCanvasElement;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #controls: OrbitControls;
  readonly #afterDrawing: (() => void)[] = [];
  /** Called with false when the view begins to move, and with true after it. */
  onDetail: (isFull: boolean) => void = () => {};
  readonly redraw = onceAFrame(() => this.#draw());
  #settling: ReturnType<typeof setTimeout> | null = null; // until all details are drawn
  #isOwnView = false; // the user has changed the view
  #home = new Box3(new Vector3(-5, -5, 0), new Vector3(5, 5, 2));

  /** Throws without WebGL. */
  constructor(host: HTMLElement) {
    this.#renderer = new WebGLRenderer({ antialias: !isDrawnInSoftware(), alpha: true });
    this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.canvas = this.#renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "Map. Arrow keys rotate, plus and minus zoom, Home shows all.");
    host.prepend(this.canvas);
    this.camera.up.copy(kUp);
    this.map.matrixAutoUpdate = false;
    this.#scene.add(this.room);
    this.room.add(this.map);
    this.#controls = this.#makeControls();
    this.canvas.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.#resize(host)).observe(host);
    onThemeChange(this.redraw);
    this.showAll();
  }

  #makeControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.zoomToCursor = true;
    controls.maxPolarAngle = 0.98 * Math.PI;
    controls.addEventListener("change", () => this.moved());
    controls.addEventListener("start", () => (this.#isOwnView = true));
    return controls;
  }

  /** Redraws with few details, which takes less time, and soon after with all. */
  moved(): void {
    this.onDetail(false);
    this.redraw();
    if (this.#settling) clearTimeout(this.#settling);
    this.#settling = setTimeout(() => {
      this.#settling = null;
      this.onDetail(true);
      this.redraw();
    }, kSettling);
  }

  /** Sets the pose of the map frame in the view. */
  placeMap(viewFromMap: Matrix4): void {
    this.map.matrix.copy(viewFromMap);
    this.map.updateMatrixWorld(true);
    this.redraw();
  }

  get viewFromMap(): Matrix4 {
    return this.map.matrix;
  }

  add(thing: Object3D): void {
    this.room.add(thing);
  }

  /** Sets the extent of showAll in the view frame; shows it unless the user has changed the view. */
  setExtent(extent: Box3): void {
    this.#home = extent.clone();
    if (!this.#isOwnView) this.showAll();
  }

  showAll(): void {
    this.#isOwnView = false;
    this.#look(new Vector3(-0.55, -0.85, 0.75));
  }

  showFromAbove(): void {
    this.#isOwnView = true;
    this.#look(new Vector3(0, -0.001, 1));
  }

  #look(direction: Vector3): void {
    const centre = this.#home.getCenter(new Vector3());
    const radius = Math.max(this.#home.getSize(new Vector3()).length() / 2, 0.5);
    const half = (this.camera.fov * Math.PI) / 360;
    const distance = (0.8 * radius) / Math.tan(half * Math.min(1, this.camera.aspect));
    this.#controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction.clone().normalize(), distance);
    this.#controls.update();
    this.redraw();
  }

  /** Centres the view on a point, without rotation or zoom. */
  follow(pointInView: Vector3): void {
    this.#isOwnView = true;
    const step = pointInView.clone().sub(this.#controls.target);
    this.#controls.target.add(step);
    this.camera.position.add(step);
    this.#controls.update();
    this.redraw();
  }

  /** Calls back after each drawing, for overlays. */
  afterDrawing(callback: () => void): void {
    this.#afterDrawing.push(callback);
  }

  /** Calls back after each click or tap, and after Enter with the middle of the view. */
  onClick(callback: (click: Click) => void): void {
    let pressed: { x: number; y: number } | null = null;
    this.canvas.addEventListener("pointerdown", ({ offsetX: x, offsetY: y }) => (pressed = { x, y }));
    this.canvas.addEventListener("pointerup", ({ offsetX: x, offsetY: y, button, pointerType }) => {
      const isTouch = pointerType === "touch";
      const moved = pressed ? Math.hypot(x - pressed.x, y - pressed.y) : Infinity;
      if (button === 0 && moved <= (isTouch ? kTap : kClick)) callback({ x, y, isTouch });
      pressed = null;
    });
    this.canvas.addEventListener("keydown", ({ key }) => {
      if (key !== "Enter") return;
      callback({ x: this.canvas.clientWidth / 2, y: this.canvas.clientHeight / 2, isTouch: false });
    });
  }

  /** Pixels per length of the view at the middle of the view. */
  pixelsPerUnit(): number {
    const distance = this.camera.position.distanceTo(this.#controls.target);
    return this.canvas.clientHeight / (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  /** Position on the canvas, CSS pixels; null behind the camera. */
  onPage(pointInMap: Vector3): { x: number; y: number } | null {
    const { x, y, z } = pointInMap.clone().applyMatrix4(this.map.matrixWorld).project(this.camera);
    if (z > 1) return null;
    return { x: ((x + 1) / 2) * this.canvas.clientWidth, y: ((1 - y) / 2) * this.canvas.clientHeight };
  }

  /** Projection from the map frame to clip space, -1 to 1. */
  clipFromMap(): Matrix4 {
    this.camera.updateMatrixWorld();
    return new Matrix4()
      .multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse)
      .multiply(this.map.matrixWorld);
  }

  /** Draws continuously, as during motion; returns frames per second. */
  measure(seconds: number): number {
    const context = this.#renderer.getContext();
    const pixel = new Uint8Array(4);
    this.onDetail(false);
    const start = performance.now();
    let frames = 0;
    while (performance.now() - start < 1000 * seconds) {
      this.#draw();
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel); // waits for the end of drawing
      ++frames;
    }
    this.moved();
    return (1000 * frames) / (performance.now() - start);
  }

  #draw(): void {
    this.#renderer.render(this.#scene, this.camera);
    for (const callback of this.#afterDrawing) callback();
  }

  #resize(host: HTMLElement): void {
    const { clientWidth, clientHeight } = host;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.#renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.#draw();
  }

  #key(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-kOrbitStep, 0],
      ArrowRight: [kOrbitStep, 0],
      ArrowUp: [0, -kOrbitStep],
      ArrowDown: [0, kOrbitStep],
    };
    if (event.key in turns) this.#orbit(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") this.#zoom(1 / kZoomStep);
    else if (event.key === "-") this.#zoom(kZoomStep);
    else if (event.key === "Home") this.showAll();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  #orbit(azimuth: number, polar: number): void {
    this.#isOwnView = true;
    const offset = this.camera.position.clone().sub(this.#controls.target);
    offset.applyAxisAngle(kUp, azimuth);
    const angle = Math.min(Math.max(offset.angleTo(kUp) + polar, 0.01), 0.98 * Math.PI) - offset.angleTo(kUp);
    const axis = kUp.clone().cross(offset).normalize();
    this.camera.position.copy(this.#controls.target).add(offset.applyAxisAngle(axis, angle));
    this.#controls.update();
    this.redraw();
  }

  #zoom(factor: number): void {
    this.#isOwnView = true;
    const { target } = this.#controls;
    this.camera.position.sub(target).multiplyScalar(factor).add(target);
    this.#controls.update();
    this.redraw();
  }
}
