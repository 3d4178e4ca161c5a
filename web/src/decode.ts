// What byre sends as bytes, little-endian: src/byre/viewer/web/web_bytes.h says how they lie.

export interface MapData {
  /** x, y, z of each point, in the map's frame. */
  points: Float32Array;
  /** x, y, z and a quaternion x, y, z, w of each keyframe: map_from_body. */
  keyframes: Float32Array;
}

export interface SeenImage {
  /** Number of its frame. */
  frame: number;
  /** u, v of each point seen, in pixels. */
  pixels: Float32Array;
  /** 1 online, 2 inlier, or both. */
  kinds: Uint8Array;
  jpeg: Blob;
}

export const kOnline = 1;
export const kInlier = 2;
export const kPoseLength = 7;

export function decodeMap(bytes: ArrayBuffer): MapData {
  const [points, keyframes] = new Uint32Array(bytes, 0, 2);
  return {
    points: new Float32Array(bytes, 8, 3 * points),
    keyframes: new Float32Array(bytes, 8 + 12 * points, kPoseLength * keyframes),
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
