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
    name: "Known points",
    value: ({ offline_inliers, offline_expected }) => `${offline_inliers} of ${offline_expected}`,
    title:
      "Points of the map made before that the camera sees in their place, of those that should be in view. " +
      "Few of many: things were moved, or the robot is not where it believes to be.",
  },
  {
    name: "New points",
    value: ({ online_inliers }) => `${online_inliers}`,
    title: "Points found during this drive that the camera sees again in their place",
  },
  {
    name: "Points that agree",
    value: ({ inlier_share, matches }) => `${percent(inlier_share)} of ${matches}`,
    title: "Of the points recognised in this image, how many fit the position. Below about a half it is doubtful.",
  },
  {
    name: "Spread in the image",
    value: ({ spread }) => percent(spread),
    title: "How far the points spread over the image. Points in one corner hold the position badly.",
  },
  {
    name: "Position known to",
    value: ({ sigma_mm }) => `± ${sigma_mm.toFixed(1)} mm`,
    title: "The true position is within this in two of three cases, as far as the program can tell",
  },
  {
    name: "Known and new differ",
    value: ({ disagreement_mm }) => (disagreement_mm === undefined ? "–" : `${disagreement_mm.toFixed(1)} mm`),
    title: "How far apart the positions are by the known points alone and by the new points alone",
  },
  {
    name: "Way since a known place",
    value: ({ since_offline_m }) => `${since_offline_m.toFixed(1)} m`,
    title: "Driven since known points last held the position. The error grows with it.",
  },
  {
    name: "Things moved",
    value: ({ suspended }) => `${suspended} points`,
    title: "Known points that are no longer where the map has them, as on things that were moved; they are left out",
  },
  {
    name: "Mapped on this drive",
    value: ({ online_points, online_keyframes }) => `${online_points} points, ${online_keyframes} views`,
    title: "Points found on this drive, and the images that were kept to find them",
  },
];

const kVerdictHelp = "Trusted: steer by it. Degraded: likely right, be careful. Untrusted: do not steer by it.";

/** How far the pose of the frame shown may be trusted, and why. */
export class HealthPanel {
  readonly panel: HTMLElement;
  readonly #verdict = element("p", { class: "verdict", title: kVerdictHelp });
  readonly #meaning = element("p", { class: "meaning" });
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
      element("dl", {}, ...rows),
      element("h2", { title: "What happened so far, the newest first; click one to go there" }, "Events"),
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
