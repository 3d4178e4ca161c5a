import type { FrameFields, Verdict } from "./types";

/** In the order of their numbers, from good to bad. */
export const kVerdicts: Verdict[] = ["trusted", "degraded", "untrusted"];

/** Each has a sign of its own, for those who cannot tell the colours apart. */
export const kSigns: Record<Verdict, string> = { trusted: "●", degraded: "◆", untrusted: "✕" };

const kMeanings: Record<Verdict, string> = {
  trusted: "Steer by this pose",
  degraded: "Likely right, but held by less than it should be",
  untrusted: "Do not steer by this pose",
};

/** A sentence for people. */
export function meaning(frame: FrameFields): string {
  const why = frame.doubt === "none" ? "" : `: ${frame.doubt}`;
  return kMeanings[frame.verdict] + why;
}

export function numberOf(verdict: Verdict): number {
  return kVerdicts.indexOf(verdict);
}
