import {
  BufferGeometry,
  DoubleSide,
  Float32BufferAttribute,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
  TextureLoader,
  Vector3,
} from "three";
import { currentTheme, onThemeChange } from "../theme";
import type { PlanFields } from "../types";

/** Corners of the plan image in plan metres: top left, top right, bottom right, bottom left. */
export function planCorners(plan: PlanFields): [number, number][] {
  const at = (column: number, row: number): [number, number] => [
    plan.top_left[0] + column * plan.step_right[0] + row * plan.step_down[0],
    plan.top_left[1] + column * plan.step_right[1] + row * plan.step_down[1],
  ];
  const [right, bottom] = [plan.width - 0.5, plan.height - 0.5];
  return [at(-0.5, -0.5), at(right, -0.5), at(right, bottom), at(-0.5, bottom)];
}

/** Plan image on the floor, in the view frame. changed: called when the image is loaded. */
export function planFloor(plan: PlanFields, url: string, viewFromPlan: Matrix4, changed: () => void): Mesh {
  const corners = planCorners(plan).map(([x, y]) => new Vector3(x, y, 0).applyMatrix4(viewFromPlan));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(corners.flatMap((corner) => corner.toArray()), 3));
  geometry.setAttribute("uv", new Float32BufferAttribute([0, 1, 1, 1, 1, 0, 0, 0], 2));
  geometry.setIndex([0, 3, 2, 0, 2, 1]);
  const map = new TextureLoader().load(url, changed);
  map.colorSpace = SRGBColorSpace;
  map.anisotropy = 8;
  // Drawn first and without depth, so that it hides nothing, including points below the floor.
  const material = new MeshBasicMaterial({ map, side: DoubleSide, depthTest: false, depthWrite: false });
  const dim = () => material.color.setScalar(currentTheme() === "dark" ? 0.07 : 1);
  dim();
  onThemeChange(dim);
  const floor = new Mesh(geometry, material);
  floor.renderOrder = -2;
  return floor;
}
