import { byId, element } from "./dom";
import { KeyframePictures } from "./keyframe_pictures";
import type { MapSpace } from "./map_space";
import { startScaleBar } from "./panels/scale_bar";
import { Picking } from "./picking";
import { linkToReview } from "./registry_page";
import { loadGreys, loadMap } from "./server";
import type { MapScene } from "./types";

/** Page of a map; with a plan also for picking points in both. */
export async function startMapPage(scene: MapScene, space: MapSpace): Promise<void> {
  const map = await loadMap("offline");
  space.showOffline(map);
  byId("subtitle").textContent = `${map.points.length / 3} points, ${map.keyframes.length / 7} views`;
  const greys = loadGreys();
  const changes = scene.before === null ? null : loadMap("changes");
  const { stage } = space;
  if (stage) startScaleBar(stage, scene.is_metric ? "m" : "map units");
  const pictures = stage && scene.pictures.length ? new KeyframePictures(stage, map.keyframes, scene.pictures) : null;
  if (scene.plan && !scene.is_read_only) {
    new Picking(scene, scene.plan, map, space, pictures);
  } else {
    byId("main").classList.add("alone");
    byId("next-step").textContent = scene.next_step;
    if (scene.plan_note) byId("next-step").append(" ", element("span", {}, scene.plan_note));
    if (scene.is_read_only) byId("next-step").append(" ", linkToReview());
    stage?.onClick((click) => pictures?.openAt(click));
  }
  space.showGreys(await greys);
  if (changes && scene.before !== null) space.showChanges(await changes, scene.before);
}
