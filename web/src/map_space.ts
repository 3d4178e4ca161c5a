import { Box3, type Matrix4, type Mesh } from "three";
import type { MapData } from "./decode";
import { byId, element } from "./dom";
import { actionButton, layerButton } from "./panels/layers";
import { address } from "./server";
import { extentOf } from "./space/extent";
import { viewFromMap, viewFromPlan } from "./space/frames";
import { Grid } from "./space/grid";
import { KeyframePath } from "./space/keyframes";
import { kDiamond, kDisc, Markers } from "./space/markers";
import { planFloor } from "./space/plan_floor";
import { Stage } from "./space/stage";
import type { SceneFields } from "./types";

const kPointPixels = 2.6;

function makeStage(): Stage | null {
  try {
    return new Stage(byId("stage"));
  } catch {
    byId("notice").replaceChildren(
      element("strong", {}, "This browser cannot draw in three dimensions."),
      " WebGL 2 is switched off or not supported, so the map is not shown; everything else works.",
    );
    byId("stage").classList.add("without-map");
    return null;
  }
}

/** Both maps, the plan under them, and the buttons that show and hide them. */
export class MapSpace {
  /** Null where the browser has no WebGL. */
  readonly stage: Stage | null = makeStage();
  readonly #offline = new Markers([{ colour: "offline", form: kDisc }], kPointPixels);
  readonly #online = new Markers([{ colour: "online", form: kDiamond }], kPointPixels + 0.8);
  readonly #offlinePath = new KeyframePath("path");
  readonly #onlinePath = new KeyframePath("online");
  readonly #grid = new Grid();
  #floor: Mesh | null = null;
  #offlineMap: MapData | null = null;
  #onlineMap: MapData | null = null;

  constructor(scene: SceneFields) {
    this.stage?.map.add(this.#offline.points, this.#online.points, this.#offlinePath.lines, this.#onlinePath.lines);
    this.place(scene);
  }

  /** Buttons of the things to see; a run has more of them. */
  addButtons(...more: HTMLElement[]): void {
    const { stage } = this;
    if (!stage) return;
    const shown = (name: string, title: string, mark: string, colour: string, things: { visible: boolean }[]) =>
      layerButton({
        name,
        title,
        mark,
        colour,
        isOn: true,
        set: (isOn) => {
          for (const thing of things) thing.visible = isOn;
          stage.redraw();
        },
      });
    byId("layers").append(
      shown("Known map", "Points of the map made before. Show or hide", "●", "offline", [this.#offline.points]),
      shown("Ways", "Where the camera was when the points were found. Show or hide", "—", "path", [
        this.#offlinePath.lines,
        this.#onlinePath.lines,
      ]),
      ...more,
      actionButton("All", "A", "See the whole map", () => stage.showAll()),
      actionButton("From above", "T", "Look straight down, as on a floor plan", () => stage.showFromAbove()),
    );
  }

  onlineButton(): HTMLElement {
    const things = [this.#online.points];
    return layerButton({
      name: "New on this drive",
      title: "Points found on this drive. Show or hide",
      mark: "◆",
      colour: "online",
      isOn: true,
      set: (isOn) => {
        for (const thing of things) thing.visible = isOn;
        this.stage?.redraw();
      },
    });
  }

  /** Puts the map where the scene says, on its plan if it has one. */
  place(scene: SceneFields): void {
    const { stage } = this;
    const placed = viewFromMap(scene);
    if (!stage || !placed) return;
    this.placeMap(placed);
    if (scene.plan && scene.registration && !this.#floor) {
      this.#floor = planFloor(scene.plan, address("/plan.png"), viewFromPlan(scene.plan), stage.redraw);
      stage.add(this.#floor);
      stage.showAll(); // what was looked at is elsewhere now
    }
    this.#fitView();
  }

  placeMap(placed: Matrix4): void {
    this.stage?.placeMap(placed);
    this.#fitView();
  }

  showOffline(map: MapData): void {
    this.#offlineMap = map;
    this.#offline.set(map.points);
    this.#offlinePath.set(map.keyframes);
    this.#fitView();
  }

  showOnline(map: MapData): void {
    this.#onlineMap = map;
    this.#online.set(map.points);
    this.#onlinePath.set(map.keyframes);
    this.#fitView();
  }

  /** What "All" shows: both maps, as they grow. */
  #fitView(): void {
    const { stage } = this;
    byId("stage").dataset.points = String(this.#pointCount());
    if (!stage) return;
    const extent = new Box3();
    for (const map of [this.#offlineMap, this.#onlineMap]) {
      if (map?.points.length) extent.union(extentOf(map.points, stage.viewFromMap));
    }
    if (extent.isEmpty()) return;
    stage.setExtent(extent);
    if (this.#floor) this.#grid.lines?.removeFromParent();
    else stage.add(this.#grid.fit(extent));
    stage.redraw();
  }

  #pointCount(): number {
    return ((this.#offlineMap?.points.length ?? 0) + (this.#onlineMap?.points.length ?? 0)) / 3;
  }
}
