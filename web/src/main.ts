import "./style.css";
import { byId } from "./dom";
import { startLanguage } from "./language";
import { startMapPage } from "./map_page";
import { MapSpace } from "./map_space";
import { startRegistryPage } from "./registry_page";
import { startRunPage } from "./run_page";
import { loadScene } from "./server";
import { listenToKeys } from "./shortcuts";
import { startTheme } from "./theme";

declare global {
  interface Window {
    /** For measurements: draws continuously for the given seconds; returns frames per second. */
    byreFramesPerSecond?: (seconds: number) => number;
  }
}

async function start(): Promise<void> {
  startLanguage();
  startTheme();
  const notice = byId("notice");
  const scene = await loadScene((text) => (notice.textContent = text));
  notice.textContent = "";
  document.title = `${scene.name} – byre`;
  byId("name").textContent = scene.name;
  if (scene.mode === "registry") {
    startRegistryPage(scene);
    return;
  }
  const space = new MapSpace(scene);
  window.byreFramesPerSecond = (seconds) => space.stage?.measure(seconds) ?? 0;
  if (scene.mode === "run") {
    await startRunPage(scene, space);
    return;
  }
  space.addButtons();
  listenToKeys({ a: () => space.stage?.showAll(), t: () => space.stage?.showFromAbove() });
  await startMapPage(scene, space);
}

start().catch((error: Error) => {
  byId("notice").textContent = `The page cannot be loaded: ${error.message}`;
});
