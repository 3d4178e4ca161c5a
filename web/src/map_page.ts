import { Vector3 } from "three";
import type { MapData } from "./decode";
import { isConfirmed } from "./confirm";
import { byId } from "./dom";
import { KeyframePictures } from "./keyframe_pictures";
import { MapSpace } from "./map_space";
import { PickList } from "./panels/pick_list";
import { PlanCanvas } from "./panels/plan_canvas";
import { startScaleBar } from "./panels/scale_bar";
import { address, loadGreys, loadMap, register, save } from "./server";
import { pathLines } from "./space/keyframes";
import { planFromMap } from "./space/frames";
import { PickLabels } from "./space/pick_labels";
import { pointAt } from "./space/point_picking";
import type { Stage } from "./space/stage";
import type { MapScene, Pick, PlanFields, PlanFit, RegistrationFields, Vector2Fields } from "./types";

const kPointsOnPlan = 20000;

/** Page of a map; with a plan also for picking points in both. */
export async function startMapPage(scene: MapScene, space: MapSpace): Promise<void> {
  const map = await loadMap("offline");
  space.showOffline(map);
  byId("subtitle").textContent = `${map.points.length / 3} points, ${map.keyframes.length / 7} views`;
  const greys = loadGreys();
  const { stage } = space;
  if (stage) startScaleBar(stage, scene.is_metric ? "m" : "map units");
  const pictures = stage && scene.pictures.length ? new KeyframePictures(stage, map.keyframes, scene.pictures) : null;
  if (scene.plan) {
    new Picking(scene, scene.plan, map, space, pictures);
  } else {
    byId("main").classList.add("alone");
    stage?.onClick((click) => pictures?.openAt(click));
  }
  space.showGreys(await greys);
}

function farOffWarning({ residual_m }: PlanFit): string {
  return (
    `The picks have a residual of ${residual_m.toFixed(2)} m. Poses and goals on this plan would be wrong by about ` +
    "as much. Check the picks and the scale of the plan."
  );
}

class Picking {
  readonly #scene: MapScene;
  readonly #map: MapData;
  readonly #space: MapSpace;
  readonly #pictures: KeyframePictures | null;
  readonly #plan: PlanCanvas;
  readonly #list: PickList;
  readonly #labels: PickLabels | null = null;
  readonly #picks: Pick[] = [];
  #count = 0; // picks made so far, including removed ones; numbers their names
  #pending: number | null = null; // map point picked, its place on the plan not yet
  #hovered: number | null = null;
  #fit: PlanFit | null = null;

  constructor(
    scene: MapScene,
    plan: PlanFields,
    map: MapData,
    space: MapSpace,
    pictures: KeyframePictures | null,
  ) {
    this.#scene = scene;
    this.#map = map;
    this.#space = space;
    this.#pictures = pictures;
    this.#plan = new PlanCanvas(plan, address("/plan.png"), (point) => this.#pickOnPlan(point));
    this.#list = new PickList(scene.output, {
      rename: (index, name) => this.#rename(index, name),
      remove: (index) => this.#remove(index),
      save: () => this.#save(),
    });
    byId("side").append(this.#plan.panel, this.#list.panel);
    if (space.stage) {
      this.#labels = new PickLabels(space.stage, byId("stage"));
      this.#listen(space.stage);
    }
    if (scene.registration) this.#showOnPlan(scene.registration);
    this.#show("");
  }

  #listen(stage: Stage): void {
    stage.onClick((click) => {
      if (!this.#pictures?.openAt(click)) this.#pickInMap(stage, click.x, click.y);
    });
    stage.canvas.addEventListener("pointermove", ({ offsetX, offsetY, buttons }) => {
      if (buttons === 0) this.#hover(this.#pointAt(stage, offsetX, offsetY));
    });
  }

  #pointAt(stage: Stage, x: number, y: number): number | null {
    const { clientWidth: width, clientHeight: height } = stage.canvas;
    return pointAt(this.#map.points, stage.clipFromMap(), { x, y, width, height });
  }

  #positionOf(point: number): Vector3 {
    return new Vector3().fromArray(this.#map.points, 3 * point);
  }

  #hover(point: number | null): void {
    if (point === this.#hovered) return;
    this.#hovered = point;
    this.#showLabels();
  }

  #pickInMap(stage: Stage, x: number, y: number): void {
    const point = this.#pointAt(stage, x, y);
    if (point === null) {
      this.#list.tellStep("No map point at this position. Click a point of the map.");
      return;
    }
    this.#pending = point;
    this.#show();
  }

  #pickOnPlan(point: Vector2Fields): void {
    if (this.#pending === null) {
      this.#list.tellStep("Click a point of the map first.");
      return;
    }
    this.#picks.push({ name: `place ${++this.#count}`, point: this.#pending, plan: point });
    this.#pending = null;
    this.#register();
  }

  #rename(index: number, name: string): void {
    this.#picks[index].name = name;
  }

  #remove(index: number): void {
    this.#picks.splice(index, 1);
    this.#register();
  }

  async #register(): Promise<void> {
    this.#fit = null;
    this.#list.tellSaved("");
    if (this.#picks.length < 2) {
      this.#show("");
      return;
    }
    const asked = [...this.#picks];
    try {
      const fit = await register(asked);
      if (asked.length !== this.#picks.length) return; // outdated answer
      this.#fit = fit;
      this.#showOnPlan(fit.registration);
      this.#show();
    } catch (error) {
      this.#show((error as Error).message);
    }
  }

  async #save(): Promise<void> {
    const fit = this.#fit;
    if (!fit) return;
    if (fit.is_far_off && !(await isConfirmed(farOffWarning(fit), "Save anyway"))) return;
    try {
      const written = await save(this.#picks, fit.is_far_off ? fit.residual_m : undefined);
      this.#list.tellSaved(`Written: ${written.join(", ")}`);
    } catch (error) {
      this.#list.tellSaved(`Not saved: ${(error as Error).message}`);
    }
  }

  #show(problem = ""): void {
    this.#list.show(this.#picks, this.#fit, problem);
    this.#list.tellStep(
      this.#pending === null
        ? `Pick ${this.#count + 1}: click a map point whose place on the plan is known.`
        : "Now click the same place on the plan.",
    );
    this.#showMarks();
    this.#showLabels();
  }

  #showMarks(): void {
    const fitted = ({ plan }: Pick, i: number): Vector2Fields | undefined => {
      const residual = this.#fit?.residuals[i];
      return residual && [plan[0] + residual.error_m[0], plan[1] + residual.error_m[1]];
    };
    this.#plan.showMarks(
      this.#picks.map((pick, i) => ({
        at: pick.plan,
        label: String(i + 1),
        fitted: fitted(pick, i),
        isOutlier: this.#fit?.residuals[i].is_outlier,
      })),
    );
  }

  #showLabels(): void {
    const label = (text: string, point: number, kind: string) => {
      return { text, point, pointInMap: this.#positionOf(point), class: kind };
    };
    const labels = this.#picks.map(({ point }, i) =>
      label(String(i + 1), point, this.#fit?.residuals[i]?.is_outlier ? "outlier" : ""),
    );
    if (this.#pending !== null) labels.push(label("?", this.#pending, "pending"));
    if (this.#hovered !== null) labels.push(label("", this.#hovered, "hovered"));
    this.#labels?.set(labels);
  }

  /** Shows the plan below the map, and the map on the plan. */
  #showOnPlan(registration: RegistrationFields): void {
    this.#space.place({ ...this.#scene, registration });
    const toPlan = planFromMap(registration);
    const onPlan = (positions: ArrayLike<number>, step: number): Vector2Fields[] => {
      const places: Vector2Fields[] = [];
      for (let i = 0; i + 2 < positions.length; i += 3 * step) {
        const { x, y } = new Vector3(positions[i], positions[i + 1], positions[i + 2]).applyMatrix4(toPlan);
        places.push([x, y]);
      }
      return places;
    };
    const step = Math.max(1, Math.floor(this.#map.points.length / 3 / kPointsOnPlan));
    this.#plan.showMap(onPlan(pathLines(this.#map.keyframes), 1), onPlan(this.#map.points, step));
  }
}
