import type { FrameFields } from "../types";
import { numberOf } from "../verdicts";
import { kCross, kDiamond, kDisc, Markers } from "./markers";

const kPixels = 6;

/** Where the robot was in each frame, marked with the verdict it had then. Lies in the map's frame. */
export class MissionPath {
  readonly #markers = new Markers(
    [
      { colour: "trusted", form: kDisc },
      { colour: "degraded", form: kDiamond },
      { colour: "untrusted", form: kCross },
    ],
    kPixels,
  );
  #room = 0; // for so many marks
  /** How many marks there are up to each frame, it included. */
  readonly #marksUntil: number[] = [];

  get points() {
    return this.#markers.points;
  }

  clear(): void {
    this.#marksUntil.length = 0;
    this.#markers.limit(0);
  }

  /** Marks the frames that were not there the last time. */
  extend(frames: FrameFields[]): void {
    let marks = this.#marksUntil.at(-1) ?? 0;
    let begin = this.#marksUntil.length;
    if (frames.length > this.#room) {
      this.#room = Math.max(1024, 2 * frames.length);
      this.#markers.reserve(this.#room);
      this.#marksUntil.length = marks = begin = 0;
    }
    for (const { pose, verdict } of frames.slice(begin)) {
      if (pose) this.#markers.put(marks++, [pose[0], pose[1], pose[2]], numberOf(verdict));
      this.#marksUntil.push(marks);
    }
  }

  showUntil(frame: number): void {
    this.#markers.limit(this.#marksUntil[frame] ?? 0);
  }
}
