import type { FrameFields, Verdict } from "./types";

/** Verdicts from good to bad; the index is the number of the verdict. */
export const kVerdicts: Verdict[] = ["trusted", "degraded", "untrusted"];

/** Distinct signs, for colour-blind users. */
export const kSigns: Record<Verdict, string> = { trusted: "●", degraded: "◆", untrusted: "✕" };

const kMeanings: Record<Verdict, string> = {
  trusted: "Steer by the pose",
  degraded: "Weakly supported, drive slowly",
  untrusted: "Do not use the pose",
};

/** Advice of the verdict, with the reason of distrust. */
export function meaning(frame: FrameFields): string {
  const why = frame.doubt === "none" ? "" : `: ${frame.doubt}`;
  return kMeanings[frame.verdict] + why;
}

export function numberOf(verdict: Verdict): number {
  return kVerdicts.indexOf(verdict);
}
