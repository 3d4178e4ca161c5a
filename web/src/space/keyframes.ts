import { BufferGeometry, Float32BufferAttribute, LineBasicMaterial, LineSegments, Vector3 } from "three";
import { kPoseLength } from "../decode";
import { colour, onThemeChange } from "../theme";

const kJump = 8; // times the median step: longer steps are gaps in the path

function positionsOf(keyframes: Float32Array): Vector3[] {
  const positions: Vector3[] = [];
  for (let i = 0; i < keyframes.length; i += kPoseLength) {
    positions.push(new Vector3(keyframes[i], keyframes[i + 1], keyframes[i + 2]));
  }
  return positions;
}

function usualStep(positions: Vector3[]): number {
  const steps = positions.slice(1).map((position, i) => position.distanceTo(positions[i]));
  return steps.sort((a, b) => a - b)[Math.floor(steps.length / 2)] ?? 0;
}

/** End points of the line segments between consecutive keyframes, x, y, z each. */
export function pathLines(keyframes: Float32Array): number[] {
  const positions = positionsOf(keyframes);
  const longest = kJump * usualStep(positions);
  const ends: number[] = [];
  for (let i = 1; i < positions.length; ++i) {
    if (positions[i].distanceTo(positions[i - 1]) > longest) continue;
    ends.push(...positions[i - 1].toArray(), ...positions[i].toArray());
  }
  return ends;
}

/** Keyframe path of a map, as line segments. */
export class KeyframePath {
  readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor(colourName: string) {
    this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.9 }));
    this.lines.frustumCulled = false;
    const recolour = () => this.lines.material.color.set(colour(colourName));
    recolour();
    onThemeChange(recolour);
  }

  set(keyframes: Float32Array): void {
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute("position", new Float32BufferAttribute(pathLines(keyframes), 3));
  }
}
