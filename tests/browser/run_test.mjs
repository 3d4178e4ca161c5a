// End-to-end tests of the viewer during a run. Screenshots are written to the folder "screenshots".
import assert from "node:assert/strict";
import { afterEach, beforeEach, describe, test } from "node:test";
import { eventually, openPage, screenshot, startBrowser, Viewer } from "./byre.mjs";
import { differentPixels, pictureOf, settledPictureOf } from "./pixels.mjs";

const kStage = "#stage > canvas";
const kTrack = "[role=slider]";

let browser;
let viewer;
beforeEach(async () => (browser = await startBrowser()));
afterEach(async () => {
  await browser.close();
  viewer?.end();
});

/** ARIA attribute of the timeline; valuenow and valuemax are frame numbers. */
async function frameOf(page, attribute) {
  return Number(await page.locator(kTrack).getAttribute(`aria-${attribute}`));
}

describe("A run", () => {
  test("explains its figures in tooltips", async () => {
    const page = await openRun();
    await eventually(async () => (await frameOf(page, "valuenow")) > 0, () => "frames");
    for (const name of await page.locator(".health dt").all()) {
      assert.ok((await name.getAttribute("title")).length > 20, await name.innerText());
    }
    const text = await page.locator(".health dl").innerText();
    for (const term of ["Offline points", "Online points", "Suspended points"]) assert.ok(text.includes(term), term);
  });

  test("is in German in a German browser", async () => {
    const page = await openRun({ locale: "de-DE" });
    await eventually(async () => (await frameOf(page, "valuenow")) > 5, () => "frames");
    assert.equal(await page.locator("html").getAttribute("lang"), "de");
    await eventually(async () => /vertrauenswürdig|eingeschränkt/i.test(await page.locator(".verdict").innerText()), () => "a verdict");
    const texts = await page.locator("button:visible, .health dt, .health dd, .meaning, .advice, figcaption").allInnerTexts();
    const titles = await page.locator("[title]").evaluateAll((all) => all.map(({ title }) => title));
    for (const text of [...texts, ...titles]) {
      assert.doesNotMatch(text, /\b(the|of|points?|show|run|map|and|views)\b/i, "not translated");
    }
    assert.deepEqual(page.problems, []);
  });

  async function openRun(options) {
    viewer = await Viewer.start("run", "room", "--map", "part.byre", "--pace", "live", "--view", "0", "--view-for", "1000000");
    return openPage(browser, viewer.url, options);
  }

  const hasEnded = (page) => () => page.getByRole("button", { name: "Live" }).isHidden();

  test("updates while it runs, and is sent from its start to a late page", async () => {
    const page = await openRun();
    await eventually(async () => (await frameOf(page, "valuenow")) > 5, () => "frames");
    const [early, image, frame] = await viewer.whileStopped(async () => [
      await pictureOf(page, kStage),
      await pictureOf(page, "canvas.image"),
      await frameOf(page, "valuenow"),
    ]);
    await eventually(async () => (await frameOf(page, "valuenow")) > frame + 5, () => "later frames");
    assert.ok((await differentPixels(page, early, await pictureOf(page, kStage))) > 100, "the 3D view changes");
    const later = await pictureOf(page, "canvas.image");
    assert.ok((await differentPixels(page, image, later)) > 1000, "the camera image changes");
    await screenshot(page, "run_live");
    await eventually(hasEnded(page), () => "the end of the run");
    assert.equal(await frameOf(page, "valuemax"), 59);
    assert.match(await page.locator(".verdict").innerText(), /trusted/i);
    await screenshot(page, "run_ended");
    assert.deepEqual(page.problems, []);
    await page.close();
    await isSentFromItsStart();
    assert.equal(await viewer.interrupt(), 0);
  });

  // To a page opened late, dark and narrow.
  async function isSentFromItsStart() {
    const page = await openPage(browser, viewer.url, { colorScheme: "dark", viewport: { width: 420, height: 860 } });
    await eventually(async () => (await frameOf(page, "valuemax")) === 59, () => "all frames");
    await eventually(hasEnded(page), () => "the end of the run");
    await eventually(async () => /fit/.test(await page.locator("figcaption").innerText()), () => "an image");
    await page.screenshot({ path: "screenshots/run_dark_narrow.png", fullPage: true });
  }

  test("can be paused and scrubbed while it runs", async () => {
    const page = await openRun();
    await eventually(async () => (await frameOf(page, "valuenow")) > 10, () => "frames");
    const [paused, picture] = await viewer.whileStopped(async () => {
      await page.getByRole("button", { name: "Pause" }).click();
      await page.locator(".timeline[data-state=paused]").waitFor();
      return [await frameOf(page, "valuenow"), await settledPictureOf(page, "canvas.image")];
    });
    await eventually(async () => (await frameOf(page, "valuemax")) > paused + 5, () => "frames after the pause");
    assert.equal(await frameOf(page, "valuenow"), paused);
    await page.locator(kTrack).click({ position: { x: 3, y: 20 } });
    await eventually(async () => (await frameOf(page, "valuenow")) < 3, () => "the first frame");
    await eventually(
      async () => (await differentPixels(page, picture, await pictureOf(page, "canvas.image"))) > 1000,
      () => "the image of the first frame",
    );
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("l");
    await eventually(async () => (await frameOf(page, "valuenow")) > paused + 5, () => "the newest frame");
    await eventually(hasEnded(page), () => "the end of the run");
    await page.keyboard.press("Home");
    await eventually(async () => (await frameOf(page, "valuenow")) === 0, () => "the first frame");
    await page.keyboard.press(" ");
    await eventually(async () => (await frameOf(page, "valuenow")) > 20, () => "replayed frames");
    await screenshot(page, "run_played");
    assert.deepEqual(page.problems, []);
  });
});
