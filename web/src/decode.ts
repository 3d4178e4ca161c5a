// Binary messages of byre, little-endian; layout: src/byre/viewer/web/web_messages.h.

export interface MapData {
  /** x, y, z of each point in the map frame, metres. */
  points: Float32Array;
  /** map_from_body of each keyframe: x, y, z in metres and quaternion x, y, z, w. */
  keyframes: Float32Array;
  /** Origin of each point: 0 offline, 1 online. */
  origins: Uint8Array;
}

export interface SeenImage {
  /** Frame number in the run, from 0. */
  frame: number;
  /** u, v of each matched map point, pixels. */
  pixels: Float32Array;
  /** Flags of each point: 1 online, 2 inlier. */
  kinds: Uint8Array;
  jpeg: Blob;
}

export const kOnline = 1;
export const kInlier = 2;
export const kPoseLength = 7;

export function decodeMap(bytes: ArrayBuffer): MapData {
  const [points, keyframes] = new Uint32Array(bytes, 0, 2);
  const afterPoints = 8 + 12 * points;
  return {
    points: new Float32Array(bytes, 8, 3 * points),
    keyframes: new Float32Array(bytes, afterPoints, kPoseLength * keyframes),
    origins: new Uint8Array(bytes, afterPoints + 4 * kPoseLength * keyframes, points),
  };
}

export function decodeImage(bytes: ArrayBuffer): SeenImage {
  const [frame, count] = new Uint32Array(bytes, 0, 2);
  const kinds = 8 + 8 * count;
  return {
    frame,
    pixels: new Float32Array(bytes, 8, 2 * count),
    kinds: new Uint8Array(bytes, kinds, count),
    jpeg: new Blob([new Uint8Array(bytes, kinds + count)], { type: "image/jpeg" }),
  };
}
