import { Vector3 } from "three";
import type { MapData } from "./decode";
import { isConfirmed } from "./confirm";
import { byId } from "./dom";
import type { KeyframePictures } from "./keyframe_pictures";
import type { MapSpace } from "./map_space";
import { layerButton } from "./panels/layers";
import { PhotoPanel } from "./panels/photo_panel";
import { PickList, type Tool } from "./panels/pick_list";
import { PlanCanvas } from "./panels/plan_canvas";
import { address, furtherViews, propose, register, save, sigmaOfPlace } from "./server";
import { pathLines } from "./space/keyframes";
import { planFromMap } from "./space/frames";
import { PickLabels } from "./space/pick_labels";
import { pointAt } from "./space/point_picking";
import type { Stage } from "./space/stage";
import type {
  MapScene,
  NextPick,
  Pick,
  PicturePixel,
  PlanFields,
  PlanFit,
  Proposal,
  RegistrationFields,
  Vector2Fields,
} from "./types";

const kPointsOnPlan = 20000;

function farOffWarning({ residual_m }: PlanFit): string {
  return (
    `The picks have a residual of ${residual_m.toFixed(2)} m. Poses and goals on this plan would be wrong by about ` +
    "as much. Check the picks and the scale of the plan."
  );
}

/** Clicks of the present pick, before it is complete. */
interface Pending {
  point?: number; // map point
  pixels: PicturePixel[];
  plan: Vector2Fields[];
}

/** Registration of a map on its plan, by picks in both or by a proposal. */
export class Picking {
  readonly #scene: MapScene;
  readonly #map: MapData;
  readonly #space: MapSpace;
  readonly #pictures: KeyframePictures | null;
  readonly #plan: PlanCanvas;
  readonly #photos: PhotoPanel | null;
  readonly #list: PickList;
  readonly #labels: PickLabels | null = null;
  readonly #picks: Pick[] = [];
  #tool: Tool = "corner";
  #count = 0; // picks made so far, including removed ones; numbers their names
  #pending: Pending = { pixels: [], plan: [] };
  #suggested: PicturePixel[] = []; // further pictures of the pending place, or of the next best pick
  #hovered: number | null = null;
  #fit: PlanFit | null = null;
  #isProposal = false; // whether #fit is of the walls

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
    this.#photos = scene.pictures.length ? new PhotoPanel(scene.pictures, (pixel) => this.#pickInPicture(pixel)) : null;
    this.#list = new PickList(scene.output, scene.pictures.length > 0, {
      use: (tool) => this.#use(tool),
      undo: () => this.#undo(),
      rename: (index, name) => this.#rename(index, name),
      remove: (index) => this.#remove(index),
      showNext: (next) => this.#showNext(next),
      propose: () => this.#propose(),
      save: () => this.#save(),
    });
    byId("side").append(this.#plan.panel, this.#list.panel);
    if (this.#photos) this.#openPhotos(this.#photos);
    if (space.stage) {
      this.#labels = new PickLabels(space.stage, byId("stage"));
      this.#listen(space.stage);
    }
    if (scene.registration) this.#showOnPlan(scene.registration);
    this.#use("corner");
    if (scene.tags > 1) this.#register();
  }

  #openPhotos({ panel }: PhotoPanel): void {
    byId("stage").append(panel);
    byId("stage").classList.add("with-photos");
    byId("layers").append(
      layerButton({
        name: "Photographs",
        title: "Pick places in pictures, or points in the 3D map",
        isOn: true,
        set: (isOn) => {
          panel.hidden = !isOn;
          byId("stage").classList.toggle("with-photos", isOn);
        },
      }),
    );
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

  #use(tool: Tool): void {
    this.#tool = tool;
    this.#list.showTool(tool);
    this.#begin();
    this.#show();
  }

  /** Begins another pick. */
  #begin(): void {
    this.#pending = { pixels: [], plan: [] };
    this.#suggested = [];
  }

  #undo(): void {
    const { point, pixels, plan } = this.#pending;
    if (plan.length) plan.pop();
    else if (pixels.length) pixels.pop();
    else if (point !== undefined) this.#pending.point = undefined;
    this.#show();
  }

  #pickInMap(stage: Stage, x: number, y: number): void {
    const point = this.#pointAt(stage, x, y);
    if (point === null) {
      this.#list.tellStep("No map point at this position. Click a point of the map.");
      return;
    }
    this.#begin();
    this.#pending.point = point;
    this.#show();
  }

  async #pickInPicture(pixel: PicturePixel): Promise<void> {
    const pending = this.#pending;
    pending.point = undefined;
    if (this.#tool === "station") return;
    const isSamePicture = (other: PicturePixel) => other[0] === pixel[0];
    if (this.#tool === "wall") {
      pending.pixels = pending.pixels.length === 1 && pending.pixels.every(isSamePicture) ? [...pending.pixels, pixel] : [pixel];
      this.#show();
      return;
    }
    pending.pixels = [...pending.pixels.filter((other) => !isSamePicture(other)), pixel];
    this.#show();
    try {
      if (pending.pixels.length === 1) {
        const views = await furtherViews(pixel);
        if (pending !== this.#pending) return;
        this.#suggested = views;
        this.#show();
      } else {
        const sigma = await sigmaOfPlace(pending.pixels);
        if (pending !== this.#pending) return;
        this.#list.tellStep(`Now click the same place on the plan. Uncertainty in the map: ${(100 * sigma).toFixed(1)} cm`);
      }
    } catch (error) {
      this.#list.tellStep((error as Error).message);
    }
  }

  /** Whether the clicks in the map or its pictures suffice. */
  #isLocated(): boolean {
    return this.#pending.point !== undefined || (this.#photos !== null && this.#tool === "station") || this.#pending.pixels.length > 1;
  }

  #pickOnPlan(at: Vector2Fields): void {
    if (!this.#isLocated()) {
      this.#list.tellStep(this.#photos ? "Click the place in the pictures first." : "Click a point of the map first.");
      return;
    }
    const { point, pixels, plan } = this.#pending;
    plan.push(at);
    const isWall = this.#tool === "wall" && point === undefined;
    if (isWall && plan.length < 2) {
      this.#show();
      return;
    }
    const pick: Pick = { name: `place ${++this.#count}`, plan: plan[0] };
    if (point !== undefined) pick.point = point;
    else if (this.#tool === "station") pick.station = this.#photos?.chosen;
    else pick.pixels = pixels;
    if (isWall) pick.plan_end = plan[1];
    this.#picks.push(pick);
    this.#begin();
    this.#register();
  }

  #rename(index: number, name: string): void {
    this.#picks[index].name = name;
  }

  #remove(index: number): void {
    this.#picks.splice(index, 1);
    this.#register();
  }

  #showNext({ pixels }: NextPick): void {
    this.#suggested = pixels;
    this.#photos?.choose(pixels[0][0]);
    this.#show();
  }

  async #register(): Promise<void> {
    this.#fit = null;
    this.#isProposal = false;
    this.#list.tellSaved("");
    if (this.#picks.length + this.#scene.tags < 2) {
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

  async #propose(): Promise<void> {
    this.#list.tellSaved("Matching the walls");
    try {
      const proposal = await propose();
      this.#fit = proposal;
      this.#isProposal = true;
      this.#showOnPlan(proposal.registration);
      this.#list.tellSaved("Check that the map is on the walls of the plan, then save.");
      this.#list.showProposal(proposal);
    } catch (error) {
      this.#list.tellSaved((error as Error).message);
    }
  }

  async #save(): Promise<void> {
    const fit = this.#fit;
    if (!fit) return;
    const doubt = this.#isProposal ? (fit as Proposal).doubt : null;
    const warning = fit.is_far_off ? farOffWarning(fit) : doubt;
    if (warning && !(await isConfirmed(warning, "Save anyway", "Do not save"))) return;
    try {
      const written = await save(this.#isProposal ? null : this.#picks, fit.is_far_off ? fit.residual_m : undefined);
      this.#list.tellSaved(`Written: ${written.join(", ")}`);
    } catch (error) {
      this.#list.tellSaved(`Not saved: ${(error as Error).message}`);
    }
  }

  #show(problem = ""): void {
    if (!this.#isProposal) this.#list.show(this.#picks, this.#fit, problem);
    this.#list.tellStep(this.#nextStep());
    this.#showMarks();
    this.#showLabels();
  }

  #nextStep(): string {
    const { point, pixels, plan } = this.#pending;
    const pick = `Pick ${this.#count + 1}`;
    if (this.#photos === null || point !== undefined) {
      return point === undefined
        ? `${pick}: click a map point whose place on the plan is known.`
        : "Now click the same place on the plan.";
    }
    if (this.#tool === "station") return `${pick}: choose a picture, then click on the plan where the robot stood.`;
    if (this.#tool === "wall") {
      if (plan.length) return "Now click another point of the wall on the plan.";
      if (pixels.length === 2) return "Now click two points of the same wall on the plan.";
      return `${pick}: click two points along the foot of a wall, in one picture.`;
    }
    if (pixels.length === 0) return `${pick}: click a corner of a wall, a post or a door frame in a picture.`;
    if (pixels.length === 1) return "Click the same place in another picture; the marked ones show it, about at the ring.";
    return "Now click the same place on the plan.";
  }

  #showMarks(): void {
    const residualOf = (i: number) => (this.#isProposal ? undefined : this.#fit?.residuals[i]);
    const fitted = ({ plan }: Pick, i: number): Vector2Fields | undefined => {
      const residual = residualOf(i);
      return residual && [plan[0] + residual.error_m[0], plan[1] + residual.error_m[1]];
    };
    const isOutlier = (i: number) => residualOf(i)?.is_outlier;
    const pending = this.#pending.plan.map((at) => ({ at, label: "?" }));
    const marks = this.#picks.map((pick, i) => ({
      at: pick.plan,
      end: pick.plan_end,
      label: String(i + 1),
      fitted: fitted(pick, i),
      isOutlier: isOutlier(i),
    }));
    this.#plan.showMarks([...marks, ...pending], this.#fit?.next?.plan ?? null);
    const inPictures = this.#picks.flatMap(({ pixels }, i) =>
      (pixels ?? []).map((at) => ({ at, label: String(i + 1), isOutlier: isOutlier(i) })),
    );
    const pendingPixels = this.#pending.pixels.map((at) => ({ at, label: "?" }));
    this.#photos?.show([...inPictures, ...pendingPixels], this.#suggested);
  }

  #showLabels(): void {
    const label = (text: string, point: number, kind: string) => {
      return { text, point, pointInMap: this.#positionOf(point), class: kind };
    };
    const labels = this.#picks.flatMap(({ point }, i) =>
      point === undefined ? [] : [label(String(i + 1), point, this.#fit?.residuals[i]?.is_outlier ? "outlier" : "")],
    );
    if (this.#pending.point !== undefined) labels.push(label("?", this.#pending.point, "pending"));
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
