import { element } from "../dom";
import { address } from "../server";
import type { PictureFields, PicturePixel } from "../types";
import { drawCross, drawLabel, drawRing, PannedImage } from "./panned_image";

/** Mark on a picture, [keyframe, u, v]. */
export interface PhotoMark {
  at: PicturePixel;
  label: string;
  isOutlier?: boolean;
}

/** Keyframe pictures for picking: a strip of all, those with the widest view first, and the chosen one. */
export class PhotoPanel {
  readonly panel: HTMLElement;
  readonly #view: PannedImage;
  readonly #strip = element("div", { class: "strip", role: "toolbar", ariaLabel: "Pictures, widest views first" });
  readonly #caption = element("p", { class: "caption", role: "status" });
  readonly #pictures: PictureFields[]; // widest view first
  #chosen: PictureFields;
  #marks: PhotoMark[] = [];
  #suggested: PicturePixel[] = [];

  /** picked: [keyframe, u, v], shares of the picture's width and height. Precondition: there are pictures. */
  constructor(pictures: PictureFields[], picked: (pixel: PicturePixel) => void) {
    this.#pictures = [...pictures].sort((a, b) => b.width_of_view - a.width_of_view);
    this.#chosen = this.#pictures[0];
    this.#view = new PannedImage(
      "Picture of the map. Arrow keys move the cross, Enter picks its position.",
      null,
      (x, y) => picked([this.#chosen.keyframe, x / this.#view.width, y / this.#view.height]),
      (context) => this.#drawOver(context),
    );
    this.panel = element("section", { class: "photos", ariaLabel: "Pictures" }, this.#caption, this.#view.canvas, this.#strip);
    this.#fillStrip();
    this.choose(this.#chosen.keyframe);
  }

  get chosen(): number {
    return this.#chosen.keyframe;
  }

  choose(keyframe: number): void {
    this.#chosen = this.#pictures.find((picture) => picture.keyframe === keyframe) ?? this.#chosen;
    this.#view.canvas.dataset.keyframe = String(this.#chosen.keyframe);
    this.#view.load(address(`/pictures/${this.#chosen.keyframe}`));
    this.#caption.textContent = `${this.#chosen.recording}, ${this.#chosen.time_s.toFixed(1)} s`;
    for (const button of this.#strip.children) {
      button.setAttribute("aria-pressed", String((button as HTMLElement).dataset.keyframe === String(this.#chosen.keyframe)));
    }
  }

  /** suggested: where further pictures show a place; they are first in the strip. */
  show(marks: PhotoMark[], suggested: PicturePixel[]): void {
    const isSame = suggested.map(([keyframe]) => keyframe).join() === this.#suggested.map(([keyframe]) => keyframe).join();
    this.#marks = marks;
    this.#suggested = suggested;
    if (!isSame) this.#fillStrip();
    this.#view.redraw();
  }

  #fillStrip(): void {
    const first = this.#suggested.map(([keyframe]) => keyframe);
    const find = (keyframe: number) => this.#pictures.filter((picture) => picture.keyframe === keyframe);
    const rest = this.#pictures.filter(({ keyframe }) => !first.includes(keyframe));
    this.#strip.replaceChildren(
      ...first.flatMap(find).map((picture) => this.#thumbnail(picture, true)),
      ...rest.map((picture) => this.#thumbnail(picture, false)),
    );
    this.#strip.scrollLeft = 0;
  }

  #thumbnail({ keyframe, time_s }: PictureFields, isSuggested: boolean): HTMLElement {
    const image = element("img", { loading: "lazy", src: address(`/pictures/${keyframe}`), alt: `Picture at ${time_s.toFixed(1)} s` });
    const button = element("button", { type: "button", class: isSuggested ? "suggested" : "" }, image);
    button.dataset.keyframe = String(keyframe);
    button.setAttribute("aria-pressed", String(keyframe === this.#chosen.keyframe));
    button.addEventListener("click", () => this.choose(keyframe));
    return button;
  }

  #drawOver(context: CanvasRenderingContext2D): void {
    const { width, height } = this.#view;
    const isShown = ([keyframe]: PicturePixel) => keyframe === this.#chosen.keyframe;
    for (const [, u, v] of this.#suggested.filter(isShown)) drawRing(context, ...this.#view.onPage(u * width, v * height));
    for (const { at, label, isOutlier } of this.#marks.filter(({ at }) => isShown(at))) {
      const [x, y] = this.#view.onPage(at[1] * width, at[2] * height);
      drawCross(context, x, y);
      drawLabel(context, x + 16, y - 16, label, isOutlier);
    }
  }
}
