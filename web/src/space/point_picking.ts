import { Matrix4, Vector4 } from "three";

const kReach = 12; // pixels from the pointer within which a point is found
const kSlack = 3; // pixels by which a nearer point may be farther from the pointer than one behind it

/**
 * Number of the point that is meant by a place in the picture: of those close to it, the one nearest to the camera.
 * Null where there is none. clipFromMap: see Stage; x, y, width and height in pixels.
 */
export function pointAt(
  points: Float32Array,
  clipFromMap: Matrix4,
  { x, y, width, height }: { x: number; y: number; width: number; height: number },
): number | null {
  const near: { point: number; distance: number; depth: number }[] = [];
  const clip = new Vector4();
  for (let point = 0; 3 * point < points.length; ++point) {
    clip.set(points[3 * point], points[3 * point + 1], points[3 * point + 2], 1).applyMatrix4(clipFromMap);
    if (clip.w <= 0) continue;
    const dx = ((clip.x / clip.w + 1) / 2) * width - x;
    const dy = ((1 - clip.y / clip.w) / 2) * height - y;
    const distance = Math.hypot(dx, dy);
    if (distance <= kReach) near.push({ point, distance, depth: clip.w });
  }
  const closest = Math.min(...near.map(({ distance }) => distance));
  const meant = near.filter(({ distance }) => distance <= closest + kSlack);
  return meant.sort((a, b) => a.depth - b.depth)[0]?.point ?? null;
}
