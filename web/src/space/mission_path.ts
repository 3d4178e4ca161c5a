import type { FrameFields } from "../types";
import { numberOf } from "../verdicts";
import { kCross, kDiamond, kDisc, Markers } from "./markers";

const kPixels = 6;

/** Positions of the robot in the map frame, one marker per pose with the verdict of its frame. */
export class MissionPath {
  readonly #markers = new Markers(
    [
      { colour: "trusted", form: kDisc },
      { colour: "degraded", form: kDiamond },
      { colour: "untrusted", form: kCross },
    ],
    kPixels,
  );
  #room = 0; // number of reserved markers
  /** Number of markers up to and including each frame. */
  readonly #marksUntil: number[] = [];

  get points() {
    return this.#markers.points;
  }

  clear(): void {
    this.#marksUntil.length = 0;
    this.#markers.limit(0);
  }

  /** Adds markers of the frames since the last call. */
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
