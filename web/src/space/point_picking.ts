import { Matrix4, Vector4 } from "three";

const kReach = 12; // pixels
const kSlack = 3; // points this much farther from the pointer than the closest one are candidates too, pixels

/**
 * Index of the map point at a pixel of the view: the candidate nearest to the camera; null without one.
 * clipFromMap: see Stage; x, y, width, height and reach, the largest distance of a point, in pixels.
 */
export function pointAt(
  points: Float32Array,
  clipFromMap: Matrix4,
  { x, y, width, height, reach = kReach }: { x: number; y: number; width: number; height: number; reach?: number },
): number | null {
  const near: { point: number; distance: number; depth: number }[] = [];
  const clip = new Vector4();
  for (let point = 0; 3 * point < points.length; ++point) {
    clip.set(points[3 * point], points[3 * point + 1], points[3 * point + 2], 1).applyMatrix4(clipFromMap);
    if (clip.w <= 0) continue;
    const dx = ((clip.x / clip.w + 1) / 2) * width - x;
    const dy = ((1 - clip.y / clip.w) / 2) * height - y;
    const distance = Math.hypot(dx, dy);
    if (distance <= reach) near.push({ point, distance, depth: clip.w });
  }
  const closest = Math.min(...near.map(({ distance }) => distance));
  const meant = near.filter(({ distance }) => distance <= closest + kSlack);
  return meant.sort((a, b) => a.depth - b.depth)[0]?.point ?? null;
}
