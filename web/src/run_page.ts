import { Vector3 } from "three";
import { byId, element } from "./dom";
import { MapSpace } from "./map_space";
import { CameraImage } from "./panels/camera_image";
import { HealthPanel } from "./panels/health_panel";
import { layerButton, type Layer } from "./panels/layers";
import { Timeline } from "./panels/timeline";
import { Playback } from "./playback";
import { listen, loadMap } from "./server";
import { listenToKeys } from "./shortcuts";
import { upOfCamera, viewFromUp } from "./space/frames";
import { MissionPath } from "./space/mission_path";
import { Robot } from "./space/robot";
import type { RunScene } from "./types";

/** Page of a run, during and after it. */
export async function startRunPage(scene: RunScene, space: MapSpace): Promise<void> {
  byId("subtitle").textContent = scene.map ? `Mission on ${scene.map}` : "New map";
  const page = new RunPage(scene, space);
  if (scene.map) space.showOffline(await loadMap("offline"));
  page.listen();
}

class RunPage {
  readonly #scene: RunScene;
  readonly #space: MapSpace;
  readonly #playback = new Playback();
  readonly #image: CameraImage;
  readonly #health: HealthPanel;
  readonly #robot: Robot;
  readonly #path = new MissionPath();
  readonly #follow: Layer = {
    name: "Follow",
    title: "Keep the robot in the centre of the view",
    key: "F",
    isOn: false,
    set: () => this.#followRobot(),
  };
  #isPlaced: boolean; // the up direction of the map is known
  #shownImage = -1;

  constructor(scene: RunScene, space: MapSpace) {
    this.#scene = scene;
    this.#space = space;
    this.#isPlaced = scene.up_in_map !== null;
    this.#image = new CameraImage(scene.camera.width, scene.camera.height);
    this.#health = new HealthPanel((frame) => this.#playback.seek(frame));
    this.#robot = new Robot(scene.camera);
    space.stage?.map.add(this.#path.points, this.#robot.group);
    byId("side").append(this.#image.panel, this.#health.panel);
    byId("bottom").append(new Timeline(this.#playback, scene.frames).panel);
    this.#addButtons();
    this.#playback.onChange(() => this.#show());
  }

  #addButtons(): void {
    const follow = layerButton(this.#follow);
    this.#space.addButtons(this.#space.onlineButton(), follow);
    const stage = this.#space.stage;
    listenToKeys({
      " ": () => this.#playback.togglePlay(),
      ArrowLeft: () => this.#playback.step(-1),
      ArrowRight: () => this.#playback.step(1),
      PageUp: () => this.#playback.step(-20),
      PageDown: () => this.#playback.step(20),
      Home: () => this.#playback.seek(0),
      End: () => this.#playback.goLive(),
      l: () => this.#playback.goLive(),
      f: () => follow.click(),
      a: () => stage?.showAll(),
      t: () => stage?.showFromAbove(),
    });
  }

  listen(): void {
    listen({
      opened: () => {
        byId("connection").replaceChildren();
        this.#path.clear();
        this.#shownImage = -1;
        this.#playback.clear();
      },
      received: (message) => {
        if (message.frames) this.#playback.append(message.frames);
        if (message.online_map) this.#loadOnline();
        if (message.ended) this.#playback.end();
      },
      sawImage: (image) => {
        if (this.#playback.state !== "live" && this.#shownImage >= 0) return;
        this.#shownImage = image.frame;
        this.#image.show(image);
      },
      lost: () =>
        byId("connection").replaceChildren(element("span", { class: "lost" }, "No connection to byre; reconnecting")),
    });
  }

  async #loadOnline(): Promise<void> {
    this.#space.showOnline(await loadMap("online"));
  }

  #show(): void {
    const { frame, frames, shown } = this.#playback;
    if (!frame) return;
    this.#health.show(frame);
    this.#health.showEvents(frames, shown);
    if (frame.pose && !this.#isPlaced) {
      this.#isPlaced = true;
      this.#space.placeMap(viewFromUp(upOfCamera(frame.pose, this.#scene.camera.body_from_camera)));
    }
    this.#showPath();
    this.#robot.place(frame.pose);
    this.#followRobot();
    this.#space.stage?.redraw();
    if (this.#playback.state !== "live" && shown !== this.#shownImage) {
      this.#shownImage = shown;
      this.#image.request(shown);
    }
  }

  #showPath(): void {
    this.#path.extend(this.#playback.frames);
    this.#path.showUntil(this.#playback.shown);
  }

  #followRobot(): void {
    const { pose } = this.#playback.frame ?? {};
    const { stage } = this.#space;
    if (this.#follow.isOn && pose && stage) {
      stage.follow(new Vector3(pose[0], pose[1], pose[2]).applyMatrix4(stage.viewFromMap));
    }
  }
}
