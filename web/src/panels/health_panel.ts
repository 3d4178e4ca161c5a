import { element } from "../dom";
import type { FrameFields } from "../types";
import { kSigns, meaning } from "../verdicts";

const kEventsShown = 6;

interface Row {
  name: string;
  value: (frame: FrameFields) => string;
  title: string;
}

const percent = (share: number) => `${Math.round(100 * share)} %`;

const kRows: Row[] = [
  {
    name: "Offline points",
    value: ({ offline_inliers, offline_expected }) => `${offline_inliers} of ${offline_expected}`,
    title: "That hold the pose, of those expected in view",
  },
  { name: "Online points", value: ({ online_inliers }) => `${online_inliers}`, title: "That hold the pose" },
  {
    name: "Agree",
    value: ({ inlier_share, matches }) => `${percent(inlier_share)} of ${matches}`,
    title: "Share of all matches that fit the pose",
  },
  { name: "Spread", value: ({ spread }) => percent(spread), title: "Of the points, in the image where they spread least" },
  { name: "Position", value: ({ sigma_mm }) => `± ${sigma_mm.toFixed(1)} mm`, title: "One sigma" },
  {
    name: "Maps differ by",
    value: ({ disagreement_mm }) => (disagreement_mm === undefined ? "–" : `${disagreement_mm.toFixed(1)} mm`),
    title: "The poses from offline and from online points alone",
  },
  {
    name: "Since offline",
    value: ({ since_offline_m }) => `${since_offline_m.toFixed(1)} m`,
    title: "Path since offline points last held the pose",
  },
  { name: "Moved away", value: ({ suspended }) => `${suspended}`, title: "Offline points left out: not where the map has them" },
  {
    name: "Mapped",
    value: ({ online_points, online_keyframes }) => `${online_points} points, ${online_keyframes} keyframes`,
    title: "Of the online map",
  },
];

/** How far the pose of the frame shown may be trusted, and why. */
export class HealthPanel {
  readonly panel: HTMLElement;
  readonly #verdict = element("p", { class: "verdict" });
  readonly #meaning = element("p", { class: "meaning" });
  readonly #values = kRows.map(() => element("dd"));
  readonly #events = element("ol", { class: "events" });

  constructor(seek: (frame: number) => void) {
    const rows = kRows.flatMap(({ name, title }, i) => [element("dt", { title }, name), this.#values[i]]);
    this.panel = element(
      "section",
      { class: "panel health", ariaLabel: "Health" },
      this.#verdict,
      this.#meaning,
      element("dl", {}, ...rows),
      element("h2", {}, "Events"),
      this.#events,
    );
    this.#events.addEventListener("click", ({ target }) => {
      const frame = (target as HTMLElement).closest("button")?.dataset.frame;
      if (frame !== undefined) seek(Number(frame));
    });
  }

  show(frame: FrameFields): void {
    this.#verdict.textContent = `${kSigns[frame.verdict]} ${frame.verdict}`;
    this.#verdict.className = `verdict ${frame.verdict}`;
    this.#meaning.textContent = `${meaning(frame)} (${frame.state})`;
    kRows.forEach((row, i) => (this.#values[i].textContent = row.value(frame)));
  }

  /** The last events up to a frame. */
  showEvents(frames: FrameFields[], shown: number): void {
    const lines: HTMLElement[] = [];
    for (let i = shown; i >= 0 && lines.length < kEventsShown; --i) {
      for (const event of frames[i].events ?? []) lines.push(eventLine(event, i, frames[i].time_s - frames[0].time_s));
    }
    this.#events.replaceChildren(...lines);
  }
}

function eventLine(event: string, frame: number, seconds: number): HTMLElement {
  const button = element("button", { class: "quiet", type: "button" }, `${seconds.toFixed(1)} s  ${event}`);
  button.dataset.frame = String(frame);
  return element("li", {}, button);
}
