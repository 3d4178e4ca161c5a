import { element, fittedContext, onceAFrame } from "../dom";
import { colour, onThemeChange } from "../theme";
import type { PlanFields, Vector2Fields } from "../types";

const kClick = 4; // largest motion of the pointer during a click, pixels
const kKeyStep = 10; // step of the cross per arrow key, pixels

/** Mark on the plan; at: x and y on the plan, metres. */
export interface PlanMark {
  at: Vector2Fields;
  label: string;
  /** Position of the registered map point on the plan; undefined before a fit. */
  fitted?: Vector2Fields;
  isOutlier?: boolean;
}

/** Plan image for picking: click picks, wheel zooms, dragging pans, arrow keys move a cross and Enter picks at it. */
export class PlanCanvas {
  readonly panel: HTMLElement;
  readonly #canvas = element("canvas", { class: "plan", tabIndex: 0 });
  readonly #image = new Image();
  readonly #plan: PlanFields;
  readonly #picked: (point: Vector2Fields) => void;
  #scale = 1; // CSS pixels per pixel of the image
  #left = 0; // of the image on the canvas, CSS pixels
  #top = 0;
  #cross: { x: number; y: number } | null = null; // moved by keys, CSS pixels
  #marks: PlanMark[] = [];
  #path: Vector2Fields[] = []; // end points of line segments
  #points: Vector2Fields[] = [];
  readonly redraw = onceAFrame(() => this.#draw());

  constructor(plan: PlanFields, url: string, picked: (point: Vector2Fields) => void) {
    this.#plan = plan;
    this.#picked = picked;
    this.#canvas.setAttribute("role", "img");
    this.#canvas.setAttribute("aria-label", "Floor plan. Arrow keys move the cross, Enter picks its position.");
    this.panel = element("div", { class: "plan-box" }, this.#canvas);
    this.#image.addEventListener("load", () => this.#fit());
    this.#image.src = url;
    this.#listen();
    new ResizeObserver(() => this.#fit()).observe(this.#canvas);
    onThemeChange(this.redraw);
  }

  showMarks(marks: PlanMark[]): void {
    this.#marks = marks;
    this.redraw();
  }

  /** Shows the map on the plan. path: end points of line segments; points: a sample of the map points; metres. */
  showMap(path: Vector2Fields[], points: Vector2Fields[]): void {
    this.#path = path;
    this.#points = points;
    this.redraw();
  }

  #fit(): void {
    const { clientWidth, clientHeight } = this.#canvas;
    if (clientWidth === 0) return;
    this.#scale = Math.min(clientWidth / this.#plan.width, clientHeight / this.#plan.height);
    this.#left = (clientWidth - this.#scale * this.#plan.width) / 2;
    this.#top = (clientHeight - this.#scale * this.#plan.height) / 2;
    this.redraw();
  }

  /** Converts CSS pixels to plan metres; onPage is the inverse. Integer coordinates of the image are pixel centres. */
  #onPlan(x: number, y: number): Vector2Fields {
    const column = (x - this.#left) / this.#scale - 0.5;
    const row = (y - this.#top) / this.#scale - 0.5;
    const { top_left, step_right, step_down } = this.#plan;
    return [
      top_left[0] + column * step_right[0] + row * step_down[0],
      top_left[1] + column * step_right[1] + row * step_down[1],
    ];
  }

  #onPage([x, y]: Vector2Fields): [number, number] {
    const { top_left, step_right: right, step_down: down } = this.#plan;
    const determinant = right[0] * down[1] - right[1] * down[0];
    const [dx, dy] = [x - top_left[0], y - top_left[1]];
    const column = (dx * down[1] - dy * down[0]) / determinant;
    const row = (dy * right[0] - dx * right[1]) / determinant;
    return [this.#left + this.#scale * (column + 0.5), this.#top + this.#scale * (row + 0.5)];
  }

  #listen(): void {
    let pressed: { x: number; y: number; moved: boolean } | null = null;
    this.#canvas.addEventListener("pointerdown", ({ offsetX, offsetY, pointerId }) => {
      pressed = { x: offsetX, y: offsetY, moved: false };
      this.#cross = null;
      this.#canvas.setPointerCapture(pointerId);
    });
    this.#canvas.addEventListener("pointermove", ({ offsetX, offsetY }) => {
      if (!pressed) return;
      pressed.moved ||= Math.hypot(offsetX - pressed.x, offsetY - pressed.y) > kClick;
      if (!pressed.moved) return;
      this.#left += offsetX - pressed.x;
      this.#top += offsetY - pressed.y;
      Object.assign(pressed, { x: offsetX, y: offsetY });
      this.redraw();
    });
    this.#canvas.addEventListener("pointerup", ({ offsetX, offsetY }) => {
      if (pressed && !pressed.moved) this.#picked(this.#onPlan(offsetX, offsetY));
      pressed = null;
    });
    this.#canvas.addEventListener("wheel", (event) => this.#zoom(event), { passive: false });
    this.#canvas.addEventListener("keydown", (event) => this.#key(event));
  }

  #zoom(event: WheelEvent): void {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY / 500);
    this.#scale *= factor;
    this.#left = event.offsetX + factor * (this.#left - event.offsetX);
    this.#top = event.offsetY + factor * (this.#top - event.offsetY);
    this.redraw();
  }

  #key(event: KeyboardEvent): void {
    const steps: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    this.#cross ??= { x: this.#canvas.clientWidth / 2, y: this.#canvas.clientHeight / 2 };
    const step = event.shiftKey ? 1 : kKeyStep;
    if (event.key in steps) {
      this.#cross.x += step * steps[event.key][0];
      this.#cross.y += step * steps[event.key][1];
    } else if (event.key === "Enter") {
      this.#picked(this.#onPlan(this.#cross.x, this.#cross.y));
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    this.redraw();
  }

  #draw(): void {
    const context = fittedContext(this.#canvas);
    context.clearRect(0, 0, this.#canvas.clientWidth, this.#canvas.clientHeight);
    const { width, height } = this.#plan;
    if (this.#image.complete && this.#image.naturalWidth > 0) {
      context.imageSmoothingEnabled = this.#scale < 2;
      context.drawImage(this.#image, this.#left, this.#top, this.#scale * width, this.#scale * height);
    }
    this.#drawMap(context);
    for (const mark of this.#marks) this.#drawMark(context, mark);
    if (this.#cross) drawCross(context, this.#cross.x, this.#cross.y);
  }

  #drawMap(context: CanvasRenderingContext2D): void {
    context.fillStyle = colour("offline");
    context.globalAlpha = 0.35;
    for (const point of this.#points) {
      const [x, y] = this.#onPage(point);
      context.fillRect(x - 0.75, y - 0.75, 1.5, 1.5);
    }
    context.globalAlpha = 1;
    context.strokeStyle = colour("path");
    context.lineWidth = 1.5;
    context.beginPath();
    for (let i = 0; i + 1 < this.#path.length; i += 2) {
      context.moveTo(...this.#onPage(this.#path[i]));
      context.lineTo(...this.#onPage(this.#path[i + 1]));
    }
    context.stroke();
  }

  #drawMark(context: CanvasRenderingContext2D, { at, label, fitted, isOutlier }: PlanMark): void {
    const [x, y] = this.#onPage(at);
    context.strokeStyle = context.fillStyle = colour(isOutlier ? "untrusted" : "accent");
    context.lineWidth = 2;
    if (fitted) {
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(...this.#onPage(fitted));
      context.stroke();
    }
    context.beginPath();
    context.arc(x, y, 10, 0, 2 * Math.PI);
    context.fill();
    context.fillStyle = "#fff";
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(label, x, y + 0.5);
  }
}

function drawCross(context: CanvasRenderingContext2D, x: number, y: number): void {
  context.strokeStyle = colour("accent");
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x - 12, y);
  context.lineTo(x + 12, y);
  context.moveTo(x, y - 12);
  context.lineTo(x, y + 12);
  context.stroke();
}
