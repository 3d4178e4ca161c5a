// True geometry of a simulated barn: pixels at which pictures of its map show marks, and pixels of its plan.
import { readFileSync } from "node:fs";

const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
const add = (a, b) => a.map((value, i) => value + b[i]);
const minus = (a, b) => a.map((value, i) => value - b[i]);

/** Rotates by a unit quaternion w, x, y, z. */
function rotated([w, ...v], p) {
  const t = cross(v, p).map((value) => 2 * value);
  return add(p, add(t.map((value) => w * value), cross(v, t)));
}

const conjugate = ([w, x, y, z]) => [w, -x, -y, -z];
const inverse = ({ q, t }) => ({ q: conjugate(q), t: rotated(conjugate(q), t).map((value) => -value) });
const apply = ({ q, t }, p) => add(rotated(q, p), t);

function rowsOf(file) {
  const rows = readFileSync(file, "utf8").trim().split("\n").map((line) => line.split(","));
  return rows[0][0].startsWith("#") ? rows.slice(1) : rows;
}

/** Body poses by the simulation, ascending in time. */
export function trueBodies(folder) {
  return rowsOf(`${folder}/mav0/state_groundtruth_estimate0/data.csv`).map((row) => {
    const [x, y, z, ...q] = row.slice(1, 8).map(Number);
    return { time: Number(row[0]) / 1e9, q, t: [x, y, z] };
  });
}

export function nearest(bodies, time) {
  return bodies.reduce((best, body) => (Math.abs(body.time - time) < Math.abs(best.time - time) ? body : best));
}

/** Section of a map file, see docs/reference/map_format.md. */
function sectionOf(bytes, name) {
  for (let i = 0; i < bytes.readUInt32LE(12); ++i) {
    const entry = 24 + 40 * i;
    if (bytes.toString("latin1", entry, entry + 16).replace(/\0+$/, "") !== name) continue;
    const begin = Number(bytes.readBigUInt64LE(entry + 16));
    return bytes.subarray(begin, begin + Number(bytes.readBigUInt64LE(entry + 24)));
  }
  throw new Error(`no section ${name}`);
}

function poseAt(bytes, at) {
  const values = Array.from({ length: 7 }, (_, i) => bytes.readDoubleLE(at + 8 * i));
  return { q: values.slice(0, 4), t: values.slice(4) };
}

export class Barn {
  /** folder: recording of "byre simulate cowshed"; map: its map file. */
  constructor(folder, map) {
    const bytes = readFileSync(map);
    const rigs = sectionOf(bytes, "rigs");
    this.width = rigs.readInt32LE(4);
    this.height = rigs.readInt32LE(8);
    [this.focal, this.cx, this.cy] = [12, 20, 28].map((at) => rigs.readDoubleLE(at));
    this.bodyFromCamera = poseAt(rigs, 44);
    const keyframes = sectionOf(bytes, "keyframes");
    const bodies = trueBodies(folder);
    this.cameraFromWorld = [];
    for (let i = 0; i < keyframes.readUInt32LE(0); ++i) {
      const body = nearest(bodies, Number(keyframes.readBigInt64LE(4 + 244 * i)) / 1e9);
      this.cameraFromWorld.push({ body: inverse(body), place: body.t });
    }
    const first = bodies[0];
    this.marks = rowsOf(`${folder}/plan/picks.csv`).map((row) => {
      const inMap = row.slice(0, 3).map(Number);
      return { name: row[5], world: apply(first, inMap) };
    });
    const [resolution, x, y] = readFileSync(`${folder}/plan/plan.yaml`, "utf8")
      .match(/resolution: (\S+)\norigin: \[(\S+), (\S+),/)
      .slice(1)
      .map(Number);
    Object.assign(this, { resolution, origin: [x, y] });
  }

  /** Shares of a picture's width and height at which it shows a point within 9 m; null outside. */
  shareOf(keyframe, world) {
    const inCamera = apply(inverse(this.bodyFromCamera), apply(this.cameraFromWorld[keyframe].body, world));
    if (inCamera[2] < 1 || inCamera[2] > 9) return null;
    const u = (this.focal * inCamera[0]) / inCamera[2] + this.cx;
    const v = (this.focal * inCamera[1]) / inCamera[2] + this.cy;
    const share = [(u + 0.5) / this.width, (v + 0.5) / this.height];
    return share.every((value) => value > 0.05 && value < 0.95) ? share : null;
  }

  /** Marks seen in two pictures at least, with the pair of views that are farthest apart. */
  visibleMarks() {
    return this.marks.flatMap((mark) => {
      const views = this.cameraFromWorld.flatMap(({ place }, keyframe) => {
        const share = this.shareOf(keyframe, mark.world);
        return share ? [{ keyframe, share, place }] : [];
      });
      const apart = (a, b) => Math.hypot(...minus(a.place, b.place));
      let pair = null;
      for (const a of views) {
        for (const b of views) {
          if (!pair || apart(a, b) > apart(...pair)) pair = [a, b];
        }
      }
      return pair && apart(...pair) > 1 ? [{ ...mark, views: pair }] : [];
    });
  }

  /** Shares of the plan's width and height. */
  shareOnPlan([x, y], { width, height }) {
    return [(x - this.origin[0]) / this.resolution / width, 1 - (y - this.origin[1]) / this.resolution / height];
  }
}
