import { Box3, Matrix4, Vector3 } from "three";

const kSamples = 5000;
const kOutside = 0.02; // share of points cut off on each side of an axis: outliers

function quantiles(values: number[]): [number, number] {
  values.sort((a, b) => a - b);
  const last = values.length - 1;
  return [values[Math.floor(kOutside * last)], values[Math.ceil((1 - kOutside) * last)]];
}

/** Bounding box of the points in the view frame, without the farthest ones; empty without points. */
export function extentOf(points: Float32Array, viewFromMap: Matrix4): Box3 {
  const count = points.length / 3;
  const step = Math.max(1, Math.floor(count / kSamples));
  const axes: number[][] = [[], [], []];
  const point = new Vector3();
  for (let i = 0; i < count; i += step) {
    point.fromArray(points, 3 * i).applyMatrix4(viewFromMap).toArray().forEach((value, axis) => axes[axis].push(value));
  }
  if (count === 0) return new Box3();
  const [x, y, z] = axes.map(quantiles);
  return new Box3(new Vector3(x[0], y[0], z[0]), new Vector3(x[1], y[1], z[1]));
}
