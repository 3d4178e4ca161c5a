import type { FrameFields } from "./types";

/** live: at the newest frame; playing: later frames follow at the recording's own pace; paused: stays. */
export type PlaybackState = "live" | "playing" | "paused";

/** Which frame of a run is shown. The run goes on, whatever is shown. */
export class Playback {
  readonly frames: FrameFields[] = [];
  #state: PlaybackState = "live";
  #shown = -1;
  #hasEnded = false;
  #startedAt = 0; // of playing: milliseconds of the page's clock,
  #startedFrom = 0; // and seconds of the recording
  readonly #listeners: (() => void)[] = [];

  get state(): PlaybackState {
    return this.#state;
  }
  /** Number of the frame shown, -1 before the first. */
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

  /** Forgets everything: it is told anew. */
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

  /** Shows a frame and stays there. */
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
