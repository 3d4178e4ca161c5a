import type { FrameFields } from "./types";

/** live: shows the newest frame; playing: advances at the recorded pace; paused: stays at a frame. */
export type PlaybackState = "live" | "playing" | "paused";

/** Frames of a run and the one shown. Does not affect the run. */
export class Playback {
  readonly frames: FrameFields[] = [];
  #state: PlaybackState = "live";
  #shown = -1;
  #hasEnded = false;
  #startedAt = 0; // start of playing, milliseconds of the page's clock
  #startedFrom = 0; // start of playing, seconds of the recording
  readonly #listeners: (() => void)[] = [];

  get state(): PlaybackState {
    return this.#state;
  }
  /** Index of the frame shown, -1 before the first. */
  get shown(): number {
    return this.#shown;
  }
  get frame(): FrameFields | undefined {
    return this.frames[this.#shown];
  }
  get hasEnded(): boolean {
    return this.#hasEnded;
  }
  /** Seconds since the first frame. */
  secondsAt(frame: number): number {
    return frame < 0 ? 0 : this.frames[frame].time_s - this.frames[0].time_s;
  }

  onChange(listener: () => void): void {
    this.#listeners.push(listener);
  }

  /** Removes all frames, before the server sends them again. */
  clear(): void {
    this.frames.length = 0;
    this.#shown = -1;
    this.#state = "live";
    this.#hasEnded = false;
    this.#changed();
  }

  append(frames: FrameFields[]): void {
    this.frames.push(...frames);
    if (this.#state === "live") this.#shown = this.frames.length - 1;
    this.#changed();
  }

  end(): void {
    this.#hasEnded = true;
    if (this.#state === "live") this.#state = "paused";
    this.#changed();
  }

  /** Pauses at a frame. */
  seek(frame: number): void {
    this.#state = "paused";
    this.#show(frame);
  }

  step(count: number): void {
    this.seek(this.#shown + count);
  }

  goLive(): void {
    this.#state = this.#hasEnded ? "paused" : "live";
    this.#show(this.frames.length - 1);
  }

  togglePlay(): void {
    if (this.#state !== "paused") {
      this.seek(this.#shown);
      return;
    }
    if (this.frames.length === 0) return;
    const isAtEnd = this.#shown >= this.frames.length - 1;
    this.#state = "playing";
    this.#show(isAtEnd ? 0 : this.#shown);
    this.#startedAt = performance.now();
    this.#startedFrom = this.frames[this.#shown].time_s;
    requestAnimationFrame(() => this.#play());
  }

  #play(): void {
    if (this.#state !== "playing") return;
    const time = this.#startedFrom + (performance.now() - this.#startedAt) / 1000;
    let next = this.#shown;
    while (next + 1 < this.frames.length && this.frames[next + 1].time_s <= time) ++next;
    const isAtEnd = next === this.frames.length - 1;
    if (isAtEnd) this.goLive();
    else if (next !== this.#shown) this.#show(next);
    requestAnimationFrame(() => this.#play());
  }

  #show(frame: number): void {
    this.#shown = Math.max(Math.min(frame, this.frames.length - 1), Math.min(0, this.frames.length - 1));
    this.#changed();
  }

  #changed(): void {
    for (const listener of this.#listeners) listener();
  }
}
