import {
  BufferGeometry,
  DoubleSide,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  type Matrix4,
} from "three";
import { colour, onThemeChange } from "../theme";
import type { CameraFields, PoseFields } from "../types";
import { matrixOf } from "./frames";

const kDepth = 0.6; // of the drawn frustum, metres

/** Image corners at the depth of the frustum, in the camera frame. */
function corners({ width, height, focal, cx, cy }: CameraFields): number[][] {
  const at = (u: number, v: number) => [((u - cx) / focal) * kDepth, ((v - cy) / focal) * kDepth, kDepth];
  return [at(-0.5, -0.5), at(width - 0.5, -0.5), at(width - 0.5, height - 0.5), at(-0.5, height - 0.5)];
}

function edges(camera: CameraFields): number[] {
  const [a, b, c, d] = corners(camera);
  const eye = [0, 0, 0];
  return [eye, a, eye, b, eye, c, eye, d, a, b, b, c, c, d, d, a].flat();
}

function sides(camera: CameraFields): number[] {
  const [a, b, c, d] = corners(camera);
  const eye = [0, 0, 0];
  return [eye, a, b, eye, b, c, eye, c, d, eye, d, a].flat();
}

function geometryOf(positions: number[]): BufferGeometry {
  return new BufferGeometry().setAttribute("position", new Float32BufferAttribute(positions, 3));
}

/** Camera frustum at the pose of the robot, in the map frame. */
export class Robot {
  readonly group = new Group();
  readonly #bodyFromCamera: Matrix4;

  constructor(camera: CameraFields) {
    this.#bodyFromCamera = matrixOf(camera.body_from_camera);
    const line = new LineBasicMaterial();
    const face = new MeshBasicMaterial({ transparent: true, opacity: 0.14, side: DoubleSide, depthWrite: false });
    const recolour = () => {
      line.color.set(colour("robot"));
      face.color.set(colour("robot"));
    };
    recolour();
    onThemeChange(recolour);
    this.group.add(new LineSegments(geometryOf(edges(camera)), line), new Mesh(geometryOf(sides(camera)), face));
    this.group.matrixAutoUpdate = false;
    this.group.visible = false;
  }

  /** Moves the frustum; hides it without a pose. */
  place(mapFromBody: PoseFields | null): void {
    this.group.visible = mapFromBody !== null;
    if (!mapFromBody) return;
    this.group.matrix.copy(matrixOf(mapFromBody).multiply(this.#bodyFromCamera));
    this.group.updateMatrixWorld(true);
  }
}
