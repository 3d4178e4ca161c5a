import { Matrix4, Quaternion, Vector3 } from "three";
import type { PlanFields, PoseFields, RegistrationFields, SceneFields, Vector3Fields } from "../types";

// View frame, in which everything is drawn: metres, z up, origin near the map. Plan coordinates may be millions of
// metres, beyond the float precision of the graphics card.

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

/** Pose of the map in the view, with scale; null while the up direction is unknown. */
export function viewFromMap(scene: SceneFields): Matrix4 | null {
  if (scene.plan && scene.registration) return viewFromPlan(scene.plan).multiply(planFromMap(scene.registration));
  return scene.up_in_map ? viewFromUp(scene.up_in_map) : null;
}

/** Up direction in the map frame, from an upright camera: its negative y axis. */
export function upOfCamera(mapFromBody: PoseFields, bodyFromCamera: PoseFields): Vector3Fields {
  const mapFromCamera = matrixOf(mapFromBody).multiply(matrixOf(bodyFromCamera));
  const [x, y, z] = new Vector3(0, -1, 0).transformDirection(mapFromCamera).toArray();
  return [x, y, z];
}
