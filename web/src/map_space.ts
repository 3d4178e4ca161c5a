import { Box3, type Matrix4, type Mesh, Vector3 } from "three";
import type { MapData } from "./decode";
import { byId, element } from "./dom";
import { actionButton, layerButton } from "./panels/layers";
import { address } from "./server";
import { extentOf } from "./space/extent";
import { viewFromMap, viewFromPlan } from "./space/frames";
import { Grid } from "./space/grid";
import { KeyframePath } from "./space/keyframes";
import { kCross, kDiamond, kDisc, Markers } from "./space/markers";
import { planFloor } from "./space/plan_floor";
import { Stage } from "./space/stage";
import type { SceneFields } from "./types";

const kPointPixels = 2.6;
const kMarginOfNear = 0.1; // of the extent's size on each side; points outside are far, and dimmed

function makeStage(): Stage | null {
  try {
    return new Stage(byId("stage"));
  } catch {
    byId("notice").replaceChildren(
      element("strong", {}, "WebGL 2 is not available in this browser."),
      " The map is not shown. The rest of the page works.",
    );
    byId("stage").classList.add("without-map");
    return null;
  }
}

/** Both maps, the plan below them, and the buttons of the layers. */
export class MapSpace {
  /** Null without WebGL. */
  readonly stage: Stage | null = makeStage();
  readonly #offline = new Markers([{ colour: "offline", form: kDisc }], kPointPixels);
  readonly #online = new Markers([{ colour: "online", form: kDiamond }], kPointPixels + 0.8);
  readonly #offlinePath = new KeyframePath("path");
  readonly #onlinePath = new KeyframePath("online");
  readonly #changes = [
    new Markers([{ colour: "untrusted", form: kCross }], kPointPixels + 2),
    new Markers([{ colour: "trusted", form: kDiamond }], kPointPixels + 2),
  ];
  readonly #grid = new Grid();
  #floor: Mesh | null = null;
  #offlineMap: MapData | null = null;
  #onlineMap: MapData | null = null;

  constructor(scene: SceneFields) {
    this.stage?.map.add(this.#offline.points, this.#online.points, this.#offlinePath.lines, this.#onlinePath.lines);
    if (this.stage) this.stage.onDetail = (isFull) => this.#offline.setDetail(isFull);
    this.place(scene);
  }

  /** Adds the buttons of the layers; more: further buttons of a run. */
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
      shown("Offline map", "Show or hide the points of the offline map", "●", "offline", [this.#offline.points]),
      shown("Camera paths", "Show or hide the camera paths of mapping", "—", "path", [
        this.#offlinePath.lines,
        this.#onlinePath.lines,
      ]),
      ...more,
      actionButton("All", "A", "Show the whole map", () => stage.showAll()),
      actionButton("From above", "T", "View from above, as on a floor plan", () => stage.showFromAbove()),
    );
  }

  /** Draws the saved map's points in their grey values, with a button to switch. */
  showGreys(greys: Uint8Array): void {
    const { stage } = this;
    if (!stage || greys.length !== this.#pointCount()) return;
    const show = (isOn: boolean) => {
      this.#offline.setGreys(isOn ? greys : null);
      byId("layers").classList.toggle("greyed", isOn);
      stage.redraw();
    };
    byId("layers").append(
      layerButton({ name: "Grey values", title: "Draw points as bright as in the image", isOn: true, set: show }),
    );
    show(true);
  }

  /** Draws the points that a map lost since an earlier version, and those that it gained, with a button for each. */
  showChanges({ points, origins }: MapData, before: string): void {
    const { stage } = this;
    if (!stage) return;
    const show = (online: number, name: string, title: string, mark: string, colour: string) => {
      const markers = this.#changes[online];
      const chosen = points.filter((_, i) => origins[Math.floor(i / 3)] === online);
      markers.set(chosen);
      stage.map.add(markers.points);
      const set = (isOn: boolean) => {
        markers.points.visible = isOn;
        stage.redraw();
      };
      byId("layers").append(layerButton({ name: `${name}: ${chosen.length / 3}`, title, mark, colour, isOn: true, set }));
    };
    show(0, "Removed points", `Show or hide points that only ${before} has`, "×", "untrusted");
    show(1, "Added points", `Show or hide points that ${before} does not have`, "◆", "trusted");
    stage.redraw();
  }

  onlineButton(): HTMLElement {
    const things = [this.#online.points];
    return layerButton({
      name: "Online map",
      title: "Show or hide the points mapped during this run",
      mark: "◆",
      colour: "online",
      isOn: true,
      set: (isOn) => {
        for (const thing of things) thing.visible = isOn;
        this.stage?.redraw();
      },
    });
  }

  /** Places the map as in the scene: on its plan if registered, otherwise upright. */
  place(scene: SceneFields): void {
    const { stage } = this;
    const placed = viewFromMap(scene);
    if (!stage || !placed) return;
    this.placeMap(placed);
    if (scene.plan && scene.registration && !this.#floor) {
      this.#floor = planFloor(scene.plan, address("/plan.png"), viewFromPlan(scene.plan), stage.redraw);
      stage.add(this.#floor);
      stage.showAll(); // the plan moves the map in the view frame
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
    this.stage?.moved();
    this.#fitView();
  }

  showOnline(map: MapData): void {
    this.#onlineMap = map;
    this.#online.set(map.points);
    this.#onlinePath.set(map.keyframes);
    this.#fitView();
  }

  /** Updates the extent of "All": both maps. */
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
    for (const { points } of [this.#offline, this.#online]) {
      const { low, high } = points.material.uniforms;
      const margin = extent.getSize(new Vector3()).multiplyScalar(kMarginOfNear);
      low.value.copy(extent.min).sub(margin);
      high.value.copy(extent.max).add(margin);
    }
    if (this.#floor) this.#grid.lines?.removeFromParent();
    else stage.add(this.#grid.fit(extent));
    stage.redraw();
  }

  #pointCount(): number {
    return ((this.#offlineMap?.points.length ?? 0) + (this.#onlineMap?.points.length ?? 0)) / 3;
  }
}
