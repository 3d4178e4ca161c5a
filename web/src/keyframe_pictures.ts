import { byId, element } from "./dom";
import { kPoseLength } from "./decode";
import { actionButton, layerButton } from "./panels/layers";
import { address } from "./server";
import { listenToKeys } from "./shortcuts";
import { kCross, kDiamond, Markers } from "./space/markers";
import { pointAt } from "./space/point_picking";
import type { Click, Stage } from "./space/stage";
import type { PictureFields } from "./types";

const kMarkerPixels = 8;
const kReach = 9; // largest distance of a click from a marker, pixels
const kReachOfTouch = 22;

/** Markers of the keyframes with a picture, and the picture of the chosen one. */
export class KeyframePictures {
  readonly #stage: Stage;
  readonly #pictures: PictureFields[];
  readonly #positions: Float32Array;
  readonly #markers = new Markers(
    [
      { colour: "path", form: kDiamond },
      { colour: "robot", form: kCross },
    ],
    kMarkerPixels,
  );
  readonly #panel: HTMLElement;
  readonly #image = element("img", { class: "image" });
  readonly #caption = element("figcaption");
  #chosen: number | null = null; // index into #pictures

  /** keyframes: poses of all keyframes, see MapData. */
  constructor(stage: Stage, keyframes: Float32Array, pictures: PictureFields[]) {
    this.#stage = stage;
    this.#pictures = pictures;
    this.#positions = new Float32Array(
      pictures.flatMap(({ keyframe }) => Array.from(keyframes.subarray(kPoseLength * keyframe, kPoseLength * keyframe + 3))),
    );
    this.#panel = this.#makePanel();
    byId("stage").append(this.#panel);
    stage.map.add(this.#markers.points);
    byId("layers").append(
      layerButton({
        name: "Pictures",
        title: "Show or hide the places of pictures. Click a place to see its picture",
        mark: "◆",
        colour: "path",
        isOn: true,
        set: (isOn) => {
          this.#markers.points.visible = isOn;
          if (!isOn) this.#choose(null);
          stage.redraw();
        },
      }),
      actionButton("Next picture", "N", "Show the next picture", () => this.#step(1)),
    );
    listenToKeys({ n: () => this.#step(1), p: () => this.#step(-1), Escape: () => this.#choose(null) });
    this.#choose(null);
  }

  /** Shows the picture taken at the place clicked. Returns whether there is one. */
  openAt({ x, y, isTouch }: Click): boolean {
    if (!this.#markers.points.visible) return false;
    const { clientWidth: width, clientHeight: height } = this.#stage.canvas;
    const reach = isTouch ? kReachOfTouch : kReach;
    const place = pointAt(this.#positions, this.#stage.clipFromMap(), { x, y, width, height, reach });
    if (place !== null) this.#choose(place);
    return place !== null;
  }

  #makePanel(): HTMLElement {
    const button = (name: string, act: () => void) => {
      const made = element("button", { type: "button" }, name);
      made.addEventListener("click", act);
      return made;
    };
    const buttons = element(
      "p",
      { class: "buttons" },
      button("Previous", () => this.#step(-1)),
      button("Next", () => this.#step(1)),
      button("Close", () => this.#choose(null)),
    );
    const panel = element("figure", { class: "keyframe-picture" }, this.#image, this.#caption, buttons);
    panel.setAttribute("aria-label", "Picture of the map");
    return panel;
  }

  #step(by: number): void {
    const count = this.#pictures.length;
    this.#choose(this.#chosen === null ? (by > 0 ? 0 : count - 1) : (this.#chosen + by + count) % count);
  }

  #choose(place: number | null): void {
    this.#chosen = place;
    this.#panel.hidden = place === null;
    this.#markers.set(
      this.#positions,
      this.#pictures.map((_, i) => (i === place ? 1 : 0)),
    );
    this.#stage.redraw();
    if (place === null) return;
    const { keyframe, recording, time_s: time } = this.#pictures[place];
    const name = `Picture ${place + 1} of ${this.#pictures.length}`;
    this.#image.src = address(`/pictures/${keyframe}`);
    this.#image.alt = `${name}, seen by the left camera at ${time.toFixed(1)} s`;
    this.#caption.textContent = `${name}: ${recording}, ${time.toFixed(1)} s`;
    this.#panel.dataset.keyframe = String(keyframe);
  }
}
