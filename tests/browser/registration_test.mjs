// A map of a simulated barn is registered on its plan by clicks in pictures, and compared with the simulated truth.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { afterEach, beforeEach, describe, test } from "node:test";
import { Barn, nearest, trueBodies } from "./barn.mjs";
import { accessibilityFaults, eventually, openPage, outputOf, screenshot, startBrowser, Viewer } from "./byre.mjs";

const kPlan = "barn_1/plan/plan.yaml";
const kZoom = 12; // of the plan and the pictures for a click
const kWheelPixels = 500; // by which the wheel zooms by a factor of e

let browser;
let viewer;
beforeEach(async () => (browser = await startBrowser()));
afterEach(async () => {
  await browser.close();
  viewer?.end();
});

async function openMap(options, ...commandLine) {
  viewer = await Viewer.start("view", "barn_1.byre", "--plan", kPlan, "--port", "0", ...commandLine);
  const page = await openPage(browser, viewer.url, options);
  await page.locator(".photos").waitFor();
  return page;
}

/** Clicks a place of an image after zooming in at it, as a person does. share: of its width and height. */
async function clickAt(page, selector, [u, v], size) {
  const canvas = page.locator(selector);
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const scale = Math.min(box.width / size.width, box.height / size.height);
  const x = box.x + (box.width - scale * size.width) / 2 + u * scale * size.width;
  const y = box.y + (box.height - scale * size.height) / 2 + v * scale * size.height;
  const [atX, atY] = [Math.round(x), Math.round(y)]; // the wheel zooms at whole pixels
  await page.mouse.move(atX, atY);
  await page.mouse.wheel(0, -kWheelPixels * Math.log(kZoom));
  await page.mouse.click(Math.round(atX + kZoom * (x - atX)), Math.round(atY + kZoom * (y - atY)));
  await page.mouse.move(atX, atY);
  await page.mouse.wheel(0, kWheelPixels * Math.log(kZoom));
}

async function clickInPicture(page, keyframe, share) {
  await page.locator(`.strip button[data-keyframe="${keyframe}"]`).click();
  const isShown = (number) => {
    const canvas = document.querySelector(".photos canvas");
    return canvas.dataset.shown?.includes(`/pictures/${number}`);
  };
  await page.waitForFunction(isShown, keyframe);
  const picture = (number) => {
    const { naturalWidth: width, naturalHeight: height } = document.querySelector(`.strip button[data-keyframe="${number}"] img`);
    return { width, height };
  };
  await eventually(async () => (await page.evaluate(picture, keyframe)).width > 0, () => "a thumbnail");
  await clickAt(page, ".photos canvas", share, await page.evaluate(picture, keyframe));
}

async function planSize(page) {
  return page.evaluate(async () => (await (await fetch("/scene")).json()).plan);
}

async function pick(page, barn, mark, onPlan = mark.world) {
  const before = await page.locator(".picks tbody tr").count();
  for (const { keyframe, share } of mark.views) await clickInPicture(page, keyframe, share);
  await page.getByText(/Now click the same place on the plan. Uncertainty in the map/).waitFor();
  const plan = await planSize(page);
  await clickAt(page, "canvas.plan", barn.shareOnPlan(onPlan, plan), plan);
  await eventually(async () => (await page.locator(".picks tbody tr").count()) === before + 1, () => "a pick");
}

const centimetresIn = (text) => Number(/([\d.]+) cm/.exec(text)[1]);

describe("A map and a plan picture", () => {
  test("become a mission on the plan by clicks alone", async (context) => {
    const start = Date.now();
    const barn = new Barn("barn_1", "barn_1.byre");
    const marks = barn.visibleMarks();
    assert.ok(marks.length >= 5, `${marks.length} marks`);
    const page = await openMap({}, "-o", "barn-plan.byre");
    for (const mark of marks.slice(0, 6)) await pick(page, barn, mark);
    await page.getByText(/[56] picks fit, rms/).waitFor();
    const residual = centimetresIn(await page.locator(".fit").innerText());
    await page.getByText(/Next best pick: near the ring/).waitFor();
    await screenshot(page, "registration");
    await page.getByRole("button", { name: "Save the registered map" }).click();
    await page.getByText(/Written: .*barn-plan.byre/).waitFor();
    assert.deepEqual(page.problems, []);
    outputOf("run", "barn_2", "--map", "barn-plan.byre", "--plan", kPlan, "--frame", "plan", "--trajectory", "plan.txt", "--quiet");
    const truth = trueBodies("barn_2");
    const errors = readFileSync("plan.txt", "utf8").trim().split("\n").filter((line) => !line.startsWith("#")).map((line) => {
      const [time, x, y] = line.split(" ").map(Number);
      const { t } = nearest(truth, time);
      return Math.hypot(x - t[0], y - t[1]);
    });
    const rmse = Math.sqrt(errors.reduce((sum, error) => sum + error * error, 0) / errors.length);
    context.diagnostic(
      `residual ${residual} cm, position on the plan ${(100 * rmse).toFixed(1)} cm RMSE of ${errors.length} poses, ` +
        `${((Date.now() - start) / 1000).toFixed(0)} s for ${marks.slice(0, 6).length} picks and the mission`,
    );
    assert.ok(errors.length > 10, `${errors.length} poses`);
    assert.ok(residual <= 3, `residual ${residual} cm`);
    assert.ok(rmse <= 0.05, `position on the plan off by ${rmse} m`);
    const again = outputOf("register", "barn_1.byre", "--plan", kPlan, "--points", "barn-plan.picks.csv", "--json");
    assert.ok(JSON.parse(again).rms_m <= 0.03, "the written picks have the same residual");
  });

  test("report a wrong pick, which can be removed", async () => {
    const barn = new Barn("barn_1", "barn_1.byre");
    const marks = barn.visibleMarks().slice(0, 5);
    const page = await openMap();
    for (const [i, mark] of marks.entries()) {
      await pick(page, barn, mark, i === 2 ? [mark.world[0] + 1.5, mark.world[1]] : mark.world);
    }
    await page.getByText(/place 3 is wrong: it is off by 1\d\d\.\d cm/).waitFor();
    await screenshot(page, "wrong_pick");
    await page.getByRole("button", { name: "Remove place 3" }).click();
    await page.getByText(/4 picks fit, rms/).waitFor();
    await eventually(async () => (await page.getByText(/is wrong/).count()) === 0, () => "no wrong pick");
    assert.deepEqual(page.problems, []);
  });

  test("report clicks of different places", async () => {
    const barn = new Barn("barn_1", "barn_1.byre");
    const [mark] = barn.visibleMarks();
    const page = await openMap();
    await clickInPicture(page, mark.views[0].keyframe, mark.views[0].share);
    assert.ok((await page.locator(".strip .suggested").count()) > 0, "further pictures are suggested");
    const [u, v] = mark.views[1].share;
    await clickInPicture(page, mark.views[1].keyframe, [u, v > 0.5 ? v - 0.3 : v + 0.3]);
    await page.getByText(/is not the same place in each picture/).waitFor();
  });

  test("are registered by a proposal that is confirmed", async () => {
    const page = await openMap({ locale: "de-DE" }, "-o", "proposed.byre");
    await page.getByRole("button", { name: "Nach Wänden vorschlagen" }).click();
    await page.getByText(/Vorschlag: Hindernisse auf Wänden: \d+ %/).waitFor();
    await screenshot(page, "proposal");
    await page.getByRole("button", { name: "Die eingeordnete Karte speichern" }).click();
    const anyway = page.getByRole("button", { name: "Trotzdem speichern" });
    const written = page.getByText(/Geschrieben: .*proposed.byre/);
    await anyway.or(written).waitFor();
    if (await anyway.isVisible()) await anyway.click();
    await written.waitFor();
    const texts = await page.locator("button:visible, .step, .fit, .saved").allInnerTexts();
    for (const text of texts) assert.doesNotMatch(text, /\b(the|click|picture|wall|save)\b/i, "not translated");
    assert.deepEqual(page.problems, []);
  });

  test("are picked by taps on a narrow screen, with an accessible page", async () => {
    const page = await openMap({ viewport: { width: 390, height: 800 }, hasTouch: true });
    assert.deepEqual(await accessibilityFaults(page), []);
    const box = await page.locator(".photos canvas").boundingBox();
    assert.ok(box.width > 300 && box.height > 100, "the picture has room");
    await page.touchscreen.tap(box.x + 0.5 * box.width, box.y + 0.6 * box.height);
    await page.getByText(/Click the same place in another picture/).waitFor();
    await page.getByRole("button", { name: "Robot" }).click();
    await page.locator("canvas.plan").scrollIntoViewIfNeeded();
    const plan = await page.locator("canvas.plan").boundingBox();
    await page.touchscreen.tap(plan.x + 0.5 * plan.width, plan.y + 0.5 * plan.height);
    await page.getByRole("textbox", { name: "Name of pick 1" }).waitFor();
    await page.screenshot({ path: "screenshots/registration_narrow.png", fullPage: true });
  });
});
