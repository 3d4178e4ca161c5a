// Synthetic floor plan, and the pixels to click so that a map is registered on it.
import { writeFileSync } from "node:fs";

const kWidth = 480;
const kHeight = 360;
const kResolution = 0.025; // metres per pixel
const kOrigin = [-6, -4.5]; // lower left corner, metres

const kTurn = -2.32; // rotation that aligns the rendered room with the walls of the plan, radians

/** Draws a room of 8 x 6 m with a door as "NAME.pgm" and describes it in "NAME.yaml". */
export function writePlan(name) {
  const pixels = Buffer.alloc(kWidth * kHeight, 255);
  const fill = (left, top, right, bottom, grey) => {
    for (let row = top; row < bottom; ++row) pixels.fill(grey, row * kWidth + left, row * kWidth + right);
  };
  fill(75, 55, 407, 307, 60);
  fill(81, 61, 401, 301, 250);
  fill(210, 55, 260, 61, 250);
  for (let column = 130; column < 390; column += 60) fill(column, 100, column + 10, 110, 170);
  writeFileSync(`${name}.pgm`, Buffer.concat([Buffer.from(`P5\n${kWidth} ${kHeight}\n255\n`), pixels]));
  writeFileSync(`${name}.yaml`, `image: ${name}.pgm\nresolution: ${kResolution}\norigin: [${kOrigin}, 0]\n`);
  return { file: `${name}.yaml`, pixelOf };
}

const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
const unit = (a) => a.map((value) => value / Math.hypot(...a));

function turned([x, y]) {
  const [cosine, sine] = [Math.cos(kTurn), Math.sin(kTurn)];
  return [cosine * x - sine * y, sine * x + cosine * y];
}

/** Canvas pixel of a map point seen from above, with the map origin at the plan origin. */
function pixelOf({ up, points }, point, { width, height }) {
  const right = unit(cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]));
  const ahead = cross(up, right);
  const position = points.slice(3 * point, 3 * point + 3);
  const scale = Math.min(width / kWidth, height / kHeight);
  const [x, y] = turned([dot(right, position), dot(ahead, position)]);
  const column = (x - kOrigin[0]) / kResolution;
  const row = kHeight - (y - kOrigin[1]) / kResolution;
  return [(width - scale * kWidth) / 2 + scale * column, (height - scale * kHeight) / 2 + scale * row];
}
