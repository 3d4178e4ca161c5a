import { element, fittedContext, onceAFrame } from "../dom";
import type { Playback } from "../playback";
import { colour, onThemeChange } from "../theme";
import type { FrameFields, Verdict } from "../types";
import { kVerdicts, numberOf } from "../verdicts";

const kBand = 14; // height of the verdicts at the bottom, pixels
const kHeightOfVerdict: Record<Verdict, number> = { trusted: 1, degraded: 0.66, untrusted: 0.33 };

/** Frames of one column of pixels. */
interface Column {
  verdict: Verdict; // worst of the frames
  offline: number; // mean count of offline inliers
  online: number; // mean count of online inliers
}

function columnOf(frames: FrameFields[], begin: number, end: number): Column {
  let worst = 0;
  let offline = 0;
  let online = 0;
  for (let i = begin; i < end; ++i) {
    worst = Math.max(worst, numberOf(frames[i].verdict));
    offline += frames[i].offline_inliers;
    online += frames[i].online_inliers;
  }
  return { verdict: kVerdicts[worst], offline: offline / (end - begin), online: online / (end - begin) };
}

/** Slider over the frames of the run: inliers at the top, verdicts at the bottom. */
export class Timeline {
  readonly panel: HTMLElement;
  readonly #canvas: HTMLCanvasElement;
  readonly #play = element("button", { type: "button", class: "play" });
  readonly #live = element("button", { type: "button", class: "live", title: "Show the newest frame" }, "Live");
  readonly #time = element("output", { class: "time" });
  readonly #playback: Playback;
  readonly #expected: number;
  readonly redraw = onceAFrame(() => this.#draw());

  /** expected: number of frames of the whole run. */
  constructor(playback: Playback, expected: number) {
    this.#playback = playback;
    this.#expected = expected;
    this.#canvas = element("canvas", { tabIndex: 0, class: "track" });
    this.#canvas.setAttribute("role", "slider");
    this.#canvas.setAttribute("aria-label", "Frame of the run");
    this.#canvas.title =
      "Timeline of the run. Top: number of points that hold the pose, offline in green, online in purple. " +
      "Bottom: verdict. Click to show a frame.";
    this.panel = element("div", { class: "timeline" }, this.#play, this.#live, this.#canvas, this.#time);
    this.#play.addEventListener("click", () => playback.togglePlay());
    this.#live.addEventListener("click", () => playback.goLive());
    this.#listenToPointer();
    new ResizeObserver(this.redraw).observe(this.#canvas);
    playback.onChange(this.redraw);
    onThemeChange(this.redraw);
  }

  get #count(): number {
    return Math.max(this.#playback.hasEnded ? 0 : this.#expected, this.#playback.frames.length, 2);
  }

  #listenToPointer(): void {
    const seek = (event: PointerEvent) => {
      const { left, width } = this.#canvas.getBoundingClientRect();
      this.#playback.seek(Math.round(((event.clientX - left) / width) * (this.#count - 1)));
    };
    this.#canvas.addEventListener("pointerdown", (event) => {
      this.#canvas.setPointerCapture(event.pointerId);
      seek(event);
    });
    this.#canvas.addEventListener("pointermove", (event) => {
      if (this.#canvas.hasPointerCapture(event.pointerId)) seek(event);
    });
  }

  #draw(): void {
    const context = fittedContext(this.#canvas);
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    context.clearRect(0, 0, width, height);
    this.#drawColumns(context, width, height);
    this.#drawHead(context, width, height);
    this.#tell();
  }

  #drawColumns(context: CanvasRenderingContext2D, width: number, height: number): void {
    const { frames } = this.#playback;
    const columns: Column[] = [];
    for (let x = 0; x < width; ++x) {
      const begin = Math.floor((x / width) * this.#count);
      const end = Math.max(begin + 1, Math.floor(((x + 1) / width) * this.#count));
      if (end > frames.length) break;
      columns.push(columnOf(frames, begin, end));
    }
    const most = Math.max(1, ...columns.map(({ offline, online }) => offline + online));
    const scale = (height - kBand - 4) / most;
    const base = height - kBand - 2;
    const [green, purple] = [colour("offline"), colour("online")];
    const bands = Object.fromEntries(kVerdicts.map((verdict) => [verdict, colour(verdict)]));
    columns.forEach(({ verdict, offline, online }, x) => {
      context.fillStyle = green;
      context.fillRect(x, base, 1, -offline * scale);
      context.fillStyle = purple;
      context.fillRect(x, base - offline * scale, 1, -online * scale);
      context.fillStyle = bands[verdict];
      context.fillRect(x, height, 1, -kBand * kHeightOfVerdict[verdict]);
    });
  }

  #drawHead(context: CanvasRenderingContext2D, width: number, height: number): void {
    const x = Math.round(((this.#playback.shown + 0.5) / this.#count) * width);
    context.fillStyle = colour("text");
    context.fillRect(x - 1, 0, 2, height);
    context.beginPath();
    context.arc(x, 5, 5, 0, 2 * Math.PI);
    context.fill();
  }

  #tell(): void {
    const { state, shown, frames, hasEnded } = this.#playback;
    this.#play.textContent = state === "paused" ? "▶ Play" : "❚❚ Pause";
    this.#live.hidden = hasEnded;
    this.#live.setAttribute("aria-pressed", String(state === "live"));
    const seconds = this.#playback.secondsAt(shown).toFixed(1);
    const total = hasEnded ? ` / ${this.#playback.secondsAt(frames.length - 1).toFixed(1)}` : "";
    this.#time.textContent = frames.length > 0 ? `${seconds}${total} s` : "";
    const values = { min: 0, max: frames.length - 1, now: shown, text: `frame ${shown}, ${seconds} seconds` };
    for (const [name, value] of Object.entries(values)) this.#canvas.setAttribute(`aria-value${name}`, String(value));
    this.panel.dataset.state = state;
  }
}
