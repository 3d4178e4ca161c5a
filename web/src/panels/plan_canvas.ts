import { element } from "../dom";
import { colour } from "../theme";
import type { PlanFields, Vector2Fields } from "../types";
import { drawLabel, drawRing, PannedImage } from "./panned_image";

/** Mark on the plan; at: x and y on the plan, metres. */
export interface PlanMark {
  at: Vector2Fields;
  end?: Vector2Fields; // of a wall
  label: string;
  /** Position of the registered map point on the plan; undefined before a fit. */
  fitted?: Vector2Fields;
  isOutlier?: boolean;
}

/** Plan image for picking. */
export class PlanCanvas {
  readonly panel: HTMLElement;
  readonly #view: PannedImage;
  readonly #plan: PlanFields;
  #marks: PlanMark[] = [];
  #suggested: Vector2Fields | null = null;
  #path: Vector2Fields[] = []; // end points of line segments
  #points: Vector2Fields[] = [];

  constructor(plan: PlanFields, url: string, picked: (point: Vector2Fields) => void) {
    this.#plan = plan;
    this.#view = new PannedImage(
      "Floor plan. Arrow keys move the cross, Enter picks its position.",
      plan,
      (x, y) => picked(this.#onPlan(x, y)),
      (context) => this.#drawOver(context),
    );
    this.#view.canvas.classList.add("plan");
    this.panel = element("div", { class: "plan-box" }, this.#view.canvas);
    this.#view.load(url);
  }

  /** suggested: place of the next best pick. */
  showMarks(marks: PlanMark[], suggested: Vector2Fields | null): void {
    this.#marks = marks;
    this.#suggested = suggested;
    this.#view.redraw();
  }

  /** Shows the map on the plan. path: end points of line segments; points: a sample of the map points; metres. */
  showMap(path: Vector2Fields[], points: Vector2Fields[]): void {
    this.#path = path;
    this.#points = points;
    this.#view.redraw();
  }

  /** Converts pixels from the top left corner of the image to plan metres; onPage is the inverse, to CSS pixels. */
  #onPlan(x: number, y: number): Vector2Fields {
    const [column, row] = [x - 0.5, y - 0.5]; // integers are pixel centres
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
    return this.#view.onPage(column + 0.5, row + 0.5);
  }

  #drawOver(context: CanvasRenderingContext2D): void {
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
    if (this.#suggested) drawRing(context, ...this.#onPage(this.#suggested));
    for (const mark of this.#marks) this.#drawMark(context, mark);
  }

  #drawMark(context: CanvasRenderingContext2D, { at, end, label, fitted, isOutlier }: PlanMark): void {
    context.strokeStyle = colour(isOutlier ? "untrusted" : "accent");
    context.lineWidth = 2;
    for (const other of [end, fitted]) {
      if (!other) continue;
      context.beginPath();
      context.moveTo(...this.#onPage(at));
      context.lineTo(...this.#onPage(other));
      context.stroke();
    }
    drawLabel(context, ...this.#onPage(at), label, isOutlier);
  }
}
