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
    title:
      "Points of the offline map that fit the pose, of those expected in view. " +
      "A small share indicates moved objects or a wrong pose.",
  },
  {
    name: "Online points",
    value: ({ online_inliers }) => `${online_inliers}`,
    title: "Points mapped during this run that fit the pose",
  },
  {
    name: "Inliers of the matches",
    value: ({ inlier_share, matches }) => `${percent(inlier_share)} of ${matches}`,
    title: "Share of the points matched in this image that fit the pose. Below one half the pose is doubtful.",
  },
  {
    name: "Spread in the image",
    value: ({ spread }) => percent(spread),
    title:
      "Standard deviation of the fitting points in the direction of least spread, as a share of the image diagonal. " +
      "Points in one corner constrain the pose badly.",
  },
  {
    name: "Position uncertainty",
    value: ({ sigma_mm }) => `± ${sigma_mm.toFixed(1)} mm`,
    title: "Estimated standard deviation of the position",
  },
  {
    name: "Distance of the maps",
    value: ({ disagreement_mm }) => (disagreement_mm === undefined ? "–" : `${disagreement_mm.toFixed(1)} mm`),
    title: "Distance between the positions by offline points alone and by online points alone",
  },
  {
    name: "Path without offline points",
    value: ({ since_offline_m }) => `${since_offline_m.toFixed(1)} m`,
    title: "Path length since offline points last held the pose. Drift grows with it.",
  },
  {
    name: "Suspended points",
    value: ({ suspended }) => `${suspended}`,
    title: "Offline points excluded for this mission, as they have moved",
  },
  {
    name: "Online map",
    value: ({ online_points, online_keyframes }) => `${online_points} points, ${online_keyframes} views`,
    title: "Points and camera views mapped during this run",
  },
];

const kVerdictHelp =
  "Trusted: steer by the pose. Degraded: weakly supported, drive slowly. Untrusted: do not use the pose.";

/** Verdict, reason and quality measures of the frame shown, and the latest events. */
export class HealthPanel {
  readonly panel: HTMLElement;
  readonly #verdict = element("p", { class: "verdict", title: kVerdictHelp });
  readonly #meaning = element("p", { class: "meaning" });
  readonly #advice = element("p", { class: "advice" });
  readonly #values = kRows.map(() => element("dd"));
  readonly #events = element("ol", { class: "events" });

  constructor(seek: (frame: number) => void) {
    const rows = kRows.flatMap(({ name, title }, i) => {
      this.#values[i].title = title;
      return [element("dt", { title }, name), this.#values[i]];
    });
    this.panel = element(
      "section",
      { class: "panel health", ariaLabel: "Health" },
      this.#verdict,
      this.#meaning,
      this.#advice,
      element("dl", {}, ...rows),
      element("h2", { title: "Events up to the frame shown, newest first. Click an event to show its frame." }, "Events"),
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
    this.#advice.textContent = frame.advice ? `Advice: ${frame.advice}.` : "";
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
