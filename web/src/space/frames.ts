import { Matrix4, Quaternion, Vector3 } from "three";
import type { PlanFields, PoseFields, RegistrationFields, SceneFields, Vector3Fields } from "../types";

// What is drawn lies in a frame of its own, "view": metres, z up, its origin near the map. On a plan that may mean
// millions of metres away from the plan's own origin, more than the graphics card can tell apart.

export function matrixOf([x, y, z, qx, qy, qz, qw]: PoseFields, scale = 1): Matrix4 {
  return new Matrix4().compose(new Vector3(x, y, z), new Quaternion(qx, qy, qz, qw), new Vector3(scale, scale, scale));
}

export function planCentre(plan: PlanFields): Vector3 {
  const [right, down] = [plan.width / 2, plan.height / 2];
  return new Vector3(
    plan.top_left[0] + right * plan.step_right[0] + down * plan.step_down[0],
    plan.top_left[1] + right * plan.step_right[1] + down * plan.step_down[1],
    0,
  );
}

export function viewFromPlan(plan: PlanFields): Matrix4 {
  return new Matrix4().makeTranslation(planCentre(plan).negate());
}

export function planFromMap(registration: RegistrationFields): Matrix4 {
  return matrixOf(registration.pose, registration.scale);
}

export function viewFromUp(up: Vector3Fields): Matrix4 {
  const turn = new Quaternion().setFromUnitVectors(new Vector3(...up).normalize(), new Vector3(0, 0, 1));
  return new Matrix4().makeRotationFromQuaternion(turn);
}

/** Where the map is drawn; null while nothing tells which way is up. */
export function viewFromMap(scene: SceneFields): Matrix4 | null {
  if (scene.plan && scene.registration) return viewFromPlan(scene.plan).multiply(planFromMap(scene.registration));
  return scene.up_in_map ? viewFromUp(scene.up_in_map) : null;
}

/** Up as a camera that is held upright sees it: against its y axis. */
export function upOfCamera(mapFromBody: PoseFields, bodyFromCamera: PoseFields): Vector3Fields {
  const mapFromCamera = matrixOf(mapFromBody).multiply(matrixOf(bodyFromCamera));
  const [x, y, z] = new Vector3(0, -1, 0).transformDirection(mapFromCamera).toArray();
  return [x, y, z];
}
