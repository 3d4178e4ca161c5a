import { Box3, GridHelper, LineBasicMaterial, Vector3 } from "three";
import { colour, onThemeChange } from "../theme";

/** Floor grid at the height of the lowest points: cells of 1 m, of 5 or 10 m for large maps. */
export class Grid {
  lines: GridHelper | null = null;

  constructor() {
    onThemeChange(() => this.#recolour());
  }

  /** Returns the grid for an extent in the view frame. */
  fit(extent: Box3): GridHelper {
    const size = extent.getSize(new Vector3());
    const longest = Math.max(size.x, size.y, 2);
    const step = longest > 100 ? 10 : longest > 40 ? 5 : 1;
    const cells = 2 * Math.ceil((0.75 * longest) / step);
    this.lines?.removeFromParent();
    this.lines?.dispose();
    this.lines = new GridHelper(cells * step, cells);
    this.lines.rotation.x = Math.PI / 2;
    const centre = extent.getCenter(new Vector3());
    this.lines.position.set(Math.round(centre.x / step) * step, Math.round(centre.y / step) * step, extent.min.z);
    this.lines.renderOrder = -1;
    this.#recolour();
    return this.lines;
  }

  #recolour(): void {
    if (!this.lines) return;
    const material = this.lines.material as LineBasicMaterial;
    material.vertexColors = false;
    material.color.set(colour("grid"));
    material.needsUpdate = true;
  }
}
