import { element, fittedContext, onceAFrame } from "../dom";
import { colour, onThemeChange } from "../theme";

const kClick = 4; // largest motion of the pointer during a click, pixels
const kTap = 10; // the same of a finger
const kKeyStep = 10; // step of the cross per arrow key, pixels

type Place = { x: number; y: number };

/**
 * Image for picking: a click or tap picks, wheel or pinch zooms, dragging pans, arrow keys move a cross and Enter picks
 * at it. Coordinates of the image are in its pixels from its top left corner.
 */
export class PannedImage {
  readonly canvas = element("canvas", { tabIndex: 0 });
  readonly #image = new Image();
  readonly #picked: (x: number, y: number) => void;
  readonly #drawOver: (context: CanvasRenderingContext2D) => void;
  #size: { width: number; height: number } | null; // null: that of the image file
  #scale = 1; // CSS pixels per pixel of the image
  #left = 0; // of the image on the canvas, CSS pixels
  #top = 0;
  #cross: Place | null = null; // moved by keys, CSS pixels
  readonly #pressed = new Map<number, Place>(); // pointers
  #hasMoved = false;
  readonly redraw = onceAFrame(() => this.#draw());

  /** size: of the image's coordinates, if the file may be reduced. */
  constructor(
    label: string,
    size: { width: number; height: number } | null,
    picked: (x: number, y: number) => void,
    drawOver: (context: CanvasRenderingContext2D) => void,
  ) {
    this.#size = size;
    this.#picked = picked;
    this.#drawOver = drawOver;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.#image.addEventListener("load", () => this.#fit());
    this.#listen();
    new ResizeObserver(() => this.#fit()).observe(this.canvas);
    onThemeChange(this.redraw);
  }

  load(url: string): void {
    this.#image.src = url;
  }

  get width(): number {
    return this.#size?.width ?? this.#image.naturalWidth;
  }

  get height(): number {
    return this.#size?.height ?? this.#image.naturalHeight;
  }

  /** CSS pixels on the canvas. */
  onPage(x: number, y: number): [number, number] {
    return [this.#left + this.#scale * x, this.#top + this.#scale * y];
  }

  #fit(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || !this.width) return;
    this.#scale = Math.min(clientWidth / this.width, clientHeight / this.height);
    this.#left = (clientWidth - this.#scale * this.width) / 2;
    this.#top = (clientHeight - this.#scale * this.height) / 2;
    this.canvas.dataset.shown = this.#image.src;
    this.redraw();
  }

  #pick({ x, y }: Place): void {
    this.#picked((x - this.#left) / this.#scale, (y - this.#top) / this.#scale);
  }

  #listen(): void {
    const at = ({ offsetX: x, offsetY: y }: PointerEvent): Place => ({ x, y });
    this.canvas.addEventListener("pointerdown", (event) => {
      this.#hasMoved = this.#pressed.size > 0; // a second finger zooms
      this.#pressed.set(event.pointerId, at(event));
      this.#cross = null;
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const before = this.#pressed.get(event.pointerId);
      if (!before) return;
      const now = at(event);
      const reach = event.pointerType === "touch" ? kTap : kClick;
      this.#hasMoved ||= Math.hypot(now.x - before.x, now.y - before.y) > reach;
      if (this.#hasMoved) this.#move(event.pointerId, before, now);
    });
    const release = (event: PointerEvent, isPick: boolean) => {
      const wasPressed = this.#pressed.delete(event.pointerId);
      if (isPick && wasPressed && !this.#hasMoved) this.#pick(at(event));
    };
    this.canvas.addEventListener("pointerup", (event) => release(event, true));
    this.canvas.addEventListener("pointercancel", (event) => release(event, false));
    this.canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.#zoom(Math.exp(-event.deltaY / 500), { x: event.offsetX, y: event.offsetY });
      },
      { passive: false },
    );
    this.canvas.addEventListener("keydown", (event) => this.#key(event));
  }

  #move(pointer: number, before: Place, now: Place): void {
    const others = [...this.#pressed].filter(([id]) => id !== pointer).map(([, place]) => place);
    this.#pressed.set(pointer, now);
    if (others.length) {
      const [other] = others;
      const length = ({ x, y }: Place) => Math.max(1, Math.hypot(x - other.x, y - other.y));
      this.#zoom(length(now) / length(before), other);
    } else {
      this.#left += now.x - before.x;
      this.#top += now.y - before.y;
      this.redraw();
    }
  }

  #zoom(factor: number, { x, y }: Place): void {
    this.#scale *= factor;
    this.#left = x + factor * (this.#left - x);
    this.#top = y + factor * (this.#top - y);
    this.redraw();
  }

  #key(event: KeyboardEvent): void {
    const steps: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    this.#cross ??= { x: this.canvas.clientWidth / 2, y: this.canvas.clientHeight / 2 };
    const step = event.shiftKey ? 1 : kKeyStep;
    if (event.key in steps) {
      this.#cross.x += step * steps[event.key][0];
      this.#cross.y += step * steps[event.key][1];
    } else if (event.key === "Enter") {
      this.#pick(this.#cross);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    this.redraw();
  }

  #draw(): void {
    const context = fittedContext(this.canvas);
    context.clearRect(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
    if (this.#image.complete && this.#image.naturalWidth > 0) {
      context.imageSmoothingEnabled = this.#scale < 2;
      context.drawImage(this.#image, this.#left, this.#top, this.#scale * this.width, this.#scale * this.height);
    }
    this.#drawOver(context);
    if (this.#cross) drawCross(context, this.#cross.x, this.#cross.y);
  }
}

/** Disc with a text. */
export function drawLabel(context: CanvasRenderingContext2D, x: number, y: number, label: string, isOutlier = false): void {
  context.fillStyle = colour(isOutlier ? "untrusted" : "accent");
  context.beginPath();
  context.arc(x, y, 10, 0, 2 * Math.PI);
  context.fill();
  context.fillStyle = "#fff";
  context.font = "600 11px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(label, x, y + 0.5);
}

/** Dashed circle at a suggested place. */
export function drawRing(context: CanvasRenderingContext2D, x: number, y: number): void {
  context.strokeStyle = colour("degraded");
  context.lineWidth = 2.5;
  context.setLineDash([6, 4]);
  context.beginPath();
  context.arc(x, y, 22, 0, 2 * Math.PI);
  context.stroke();
  context.setLineDash([]);
}

/** Small cross at an exact place, which a label would hide. */
export function drawCross(context: CanvasRenderingContext2D, x: number, y: number): void {
  context.strokeStyle = colour("accent");
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x - 12, y);
  context.lineTo(x + 12, y);
  context.moveTo(x, y - 12);
  context.lineTo(x, y + 12);
  context.stroke();
}
