import { byId, element } from "../dom";
import type { Stage } from "../space/stage";

const kLongest = 140; // pixels

/** Greatest of 1, 2 or 5 times a power of ten that is at most the length. */
export function roundLength(longest: number): number {
  const power = 10 ** Math.floor(Math.log10(longest));
  return power * ([5, 2].find((digit) => digit * power <= longest) ?? 1);
}

/** Bar of a round length, as it appears in the middle of the view. */
export function startScaleBar(stage: Stage, unit: string): void {
  const bar = element("div", { class: "scale-bar", title: "Length in the middle of the view" });
  byId("stage").append(bar);
  stage.afterDrawing(() => {
    const pixels = stage.pixelsPerUnit();
    if (!(pixels > 0) || !Number.isFinite(pixels)) return;
    const length = roundLength(kLongest / pixels);
    bar.style.width = `${(length * pixels).toFixed(1)}px`;
    const text = `${Number(length.toPrecision(1))} ${unit}`;
    if (bar.textContent !== text) bar.textContent = text;
  });
  stage.redraw();
}
