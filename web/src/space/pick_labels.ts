import { Vector3 } from "three";
import { element } from "../dom";
import type { Stage } from "./stage";

/** Labels over the 3D view, at picked points. */
export class PickLabels {
  readonly #stage: Stage;
  readonly #layer = element("div", { class: "labels", ariaHidden: "true" });
  #labels: { element: HTMLElement; pointInMap: Vector3 }[] = [];

  constructor(stage: Stage, host: HTMLElement) {
    this.#stage = stage;
    host.append(this.#layer);
    stage.afterDrawing(() => this.#place());
  }

  /** Replaces all labels. point: index in the map. */
  set(labels: { text: string; point: number; pointInMap: Vector3; class?: string }[]): void {
    this.#labels = labels.map(({ text, point, pointInMap, class: kind }) => {
      const label = element("span", { class: `label ${kind ?? ""}` }, text);
      label.dataset.point = String(point);
      return { element: label, pointInMap };
    });
    this.#layer.replaceChildren(...this.#labels.map((label) => label.element));
    this.#stage.redraw();
  }

  #place(): void {
    for (const { element: label, pointInMap } of this.#labels) {
      const place = this.#stage.onPage(pointInMap);
      label.hidden = place === null;
      if (place) label.style.transform = `translate(${place.x}px, ${place.y}px) translate(-50%, -50%)`;
    }
  }
}
