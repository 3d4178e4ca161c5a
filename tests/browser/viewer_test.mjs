// End-to-end tests of the viewer with a map in a browser. Screenshots are written to the folder "screenshots".
import assert from "node:assert/strict";
import { existsSync, readFileSync, rmSync } from "node:fs";
import { afterEach, beforeEach, describe, test } from "node:test";
import { accessibilityFaults, eventually, openPage, outputOf, screenshot, startBrowser, Viewer } from "./byre.mjs";
import { differentPixels, settledPictureOf } from "./pixels.mjs";
import { writePlan } from "./plan.mjs";

const kStage = "#stage > canvas";

let browser;
let viewer;
beforeEach(async () => (browser = await startBrowser()));
afterEach(async () => {
  await browser.close();
  viewer?.end();
});

async function pointCount(page) {
  return Number(await page.locator("#stage").getAttribute("data-points"));
}

async function openMap(options, ...commandLine) {
  return openMapFile("room.byre", options, ...commandLine);
}

async function openMapFile(file, options, ...commandLine) {
  viewer = await Viewer.start("view", file, "--port", "0", ...commandLine);
  const page = await openPage(browser, viewer.url, options);
  await eventually(async () => (await pointCount(page)) > 0, () => "points of the map");
  return page;
}

describe("A map", () => {
  test("is drawn without console messages", async () => {
    const page = await openMap();
    assert.ok((await pointCount(page)) > 500);
    const withPoints = await settledPictureOf(page, kStage);
    await page.getByRole("button", { name: "Offline map" }).click();
    const without = await settledPictureOf(page, kStage);
    assert.ok((await differentPixels(page, withPoints, without)) > 500, "hiding the points changes the view");
    await page.getByRole("button", { name: "Offline map" }).click();
    assert.equal(await differentPixels(page, withPoints, await settledPictureOf(page, kStage)), 0);
    await screenshot(page, "map");
    assert.deepEqual(page.problems, []);
  });

  test("rotates by keys and has a view from above", async () => {
    const page = await openMap();
    const before = await settledPictureOf(page, kStage);
    await page.locator(kStage).focus();
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("+");
    assert.ok((await differentPixels(page, before, await settledPictureOf(page, kStage))) > 500);
    await page.keyboard.press("t");
    await settledPictureOf(page, kStage);
    await screenshot(page, "map_from_above");
  });

  test("is drawn in a dark, narrow window", async () => {
    const page = await openMap({ colorScheme: "dark", viewport: { width: 420, height: 860 } });
    assert.equal(await page.locator("html").getAttribute("data-theme"), "dark");
    await screenshot(page, "map_dark_narrow");
    assert.deepEqual(page.problems, []);
  });

  test("is reported as missing without WebGL", async () => {
    viewer = await Viewer.start("view", "room.byre", "--port", "0");
    const plain = await startBrowser({ webgl: false });
    const page = await openPage(plain, viewer.url);
    await page.getByText("WebGL 2 is not available").waitFor();
    await screenshot(page, "without_webgl");
    await plain.close();
  });

  test("requires the token from other hosts", async () => {
    viewer = await Viewer.start("view", "room.byre", "--port", "0", "--bind", "0.0.0.0");
    const page = await openPage(browser, viewer.url);
    await eventually(async () => (await pointCount(page)) > 0, () => "points of the map");
    const stranger = await browser.newPage();
    assert.equal((await stranger.goto(viewer.url.replace(/token=.*/, ""))).status(), 403);
  });

  test("ends by Ctrl-C with an open page", async () => {
    await openMap();
    assert.equal(await viewer.interrupt(), 0);
  });
});

describe("A changed map", () => {
  test("shows what it lost since an earlier version", async () => {
    const page = await openMapFile("cut.byre", { locale: "de-DE" }, "--before", "room.byre");
    const removed = page.getByRole("button", { name: /Entfernte Punkte: \d+/ });
    await removed.waitFor();
    await page.getByRole("button", { name: /Neue Punkte: 0/ }).waitFor();
    const count = Number(/\d+/.exec(await removed.innerText())[0]);
    const figures = JSON.parse(outputOf("diff", "room.byre", "cut.byre", "--json")).points;
    assert.equal(count, figures.removed);
    assert.ok(count > 50, `${count} points removed`);
    const withRemoved = await settledPictureOf(page, kStage);
    await removed.click();
    assert.ok((await differentPixels(page, withRemoved, await settledPictureOf(page, kStage))) > 50);
    await page.getByText(/^Bereit für Fahrten. Nächster Schritt: byre run RECORDING --map cut.byre oder/).waitFor();
    await screenshot(page, "changes");
    assert.deepEqual(page.problems, []);
  });
});

describe("Pictures of a map", () => {
  const kPicture = "figure.keyframe-picture";

  async function openPictures(options) {
    const page = await openMap(options);
    await page.getByRole("button", { name: "Next picture" }).waitFor();
    return page;
  }

  async function shownPicture(page) {
    const width = () => document.querySelector("figure.keyframe-picture img").naturalWidth;
    await eventually(async () => (await page.evaluate(width)) > 100, () => "a picture");
    return page.locator(`${kPicture} figcaption`).innerText();
  }

  /** Presses places in a spiral around the middle of the map until a picture is shown. */
  async function findPicture(page, press) {
    const box = await page.locator(kStage).boundingBox();
    for (let turn = 0; turn < 400; ++turn) {
      const radius = 6 * Math.sqrt(turn);
      const [x, y] = [radius * Math.cos(2.4 * turn), radius * Math.sin(2.4 * turn)];
      await press(box.x + box.width / 2 + x, box.y + box.height / 2 + y);
      if (await page.locator(kPicture).isVisible()) return;
    }
    throw new Error("no picture found");
  }

  test("are shown by keys and buttons", async () => {
    const page = await openPictures();
    assert.ok(await page.locator(kPicture).isHidden());
    await page.keyboard.press("n");
    const first = await shownPicture(page);
    assert.match(first, /^Picture 1 of \d+: room, \d+\.\d s$/);
    await page.getByRole("button", { name: "Next", exact: true }).click();
    assert.match(await shownPicture(page), /^Picture 2 of/);
    await page.keyboard.press("p");
    assert.equal(await shownPicture(page), first);
    await screenshot(page, "picture");
    await page.keyboard.press("Escape");
    assert.ok(await page.locator(kPicture).isHidden());
    assert.deepEqual(page.problems, []);
  });

  test("are shown by a click on their place", async () => {
    const page = await openPictures();
    await findPicture(page, (x, y) => page.mouse.click(x, y));
    await shownPicture(page);
    await page.getByRole("button", { name: "Pictures" }).click();
    assert.ok(await page.locator(kPicture).isHidden());
  });

  test("are shown by a tap on a narrow, dark screen", async () => {
    const options = { colorScheme: "dark", viewport: { width: 360, height: 740 }, hasTouch: true };
    const page = await openPictures(options);
    await findPicture(page, (x, y) => page.touchscreen.tap(x, y));
    await shownPicture(page);
    const box = await page.locator(kPicture).boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 360, "the picture fits on the screen");
    await page.screenshot({ path: "screenshots/picture_dark_narrow.png", fullPage: true });
    assert.deepEqual(page.problems, []);
  });

  test("are not offered for a map without", async () => {
    const page = await openMapFile("plain.byre");
    await page.getByRole("button", { name: "Grey values" }).waitFor();
    assert.equal(await page.getByRole("button", { name: "Pictures" }).count(), 0);
    await page.keyboard.press("n");
    assert.equal(await page.locator(kPicture).count(), 0);
    assert.deepEqual(page.problems, []);
  });

  test("keep the page accessible, light and dark", async () => {
    for (const colorScheme of ["light", "dark"]) {
      const page = await openPictures({ colorScheme });
      await page.keyboard.press("n");
      await shownPicture(page);
      assert.deepEqual(await accessibilityFaults(page), [], colorScheme);
      await page.close();
      viewer.end();
    }
  });
});

describe("Points of a map", () => {
  test("have the grey values of the images, light and dark", async () => {
    const page = await openMap();
    await page.getByRole("button", { name: "Pictures" }).click();
    const grey = await settledPictureOf(page, kStage);
    await page.getByRole("button", { name: "Grey values" }).click();
    const green = await settledPictureOf(page, kStage);
    assert.ok((await differentPixels(page, grey, green)) > 500, "the colour of the points changes");
    await page.getByRole("button", { name: "Grey values" }).click();
    assert.equal(await differentPixels(page, grey, await settledPictureOf(page, kStage)), 0);
    await page.getByRole("button", { name: "Dark" }).click();
    await settledPictureOf(page, kStage);
    await screenshot(page, "grey_dark");
  });

  test("have a scale bar that grows when zoomed", async () => {
    const page = await openMap();
    const metresPerPixel = async () => {
      const bar = page.locator(".scale-bar");
      const [length, unit] = (await bar.innerText()).split(" ");
      assert.equal(unit, "m");
      const { width } = await bar.boundingBox();
      assert.ok(width > 40 && width <= 141, `${width} pixels`);
      return Number(length) / width;
    };
    await eventually(async () => (await page.locator(".scale-bar").innerText()) !== "", () => "a scale bar");
    const before = await metresPerPixel();
    await page.locator(kStage).focus();
    for (let i = 0; i < 10; ++i) await page.keyboard.press("+");
    await settledPictureOf(page, kStage);
    const ratio = before / (await metresPerPixel());
    assert.ok(Math.abs(ratio / 1.15 ** 10 - 1) < 0.05, `ratio ${ratio}`);
  });
});

describe("Picking", () => {
  /** Clicks along a spiral until a map point is hit. */
  async function pickInMap(page, { x, y }) {
    const photographs = page.getByRole("button", { name: "Photographs" });
    if ((await photographs.getAttribute("aria-pressed")) === "true") await photographs.click();
    const box = await page.locator(kStage).boundingBox();
    for (let turn = 0; turn < 40; ++turn) {
      const [dx, dy] = [8 * turn * Math.cos(2.4 * turn), 5 * turn * Math.sin(2.4 * turn)];
      await page.mouse.click(box.x + x * box.width + dx, box.y + y * box.height + dy);
      if (await page.getByText("Now click the same place on the plan").isVisible()) return;
    }
    throw new Error("no map point found by clicks");
  }

  test("three points registers the map on the plan, and saving stores it", async () => {
    const plan = writePlan("room-plan");
    const page = await openMap({}, "--plan", plan.file, "-o", "room-plan.byre");
    const map = await page.evaluate(async () => {
      const [scene, bytes] = await Promise.all([
        fetch("/scene").then((response) => response.json()),
        fetch("/map/offline").then((response) => response.arrayBuffer()),
      ]);
      const count = new Uint32Array(bytes, 0, 1)[0];
      return { up: scene.up_in_map, points: Array.from(new Float32Array(bytes, 8, 3 * count)) };
    });
    const canvas = await page.locator("canvas.plan").boundingBox();
    for (const place of [{ x: 0.2, y: 0.5 }, { x: 0.8, y: 0.6 }, { x: 0.35, y: 0.3 }]) {
      await pickInMap(page, place);
      const point = Number(await page.locator(".label.pending").getAttribute("data-point"));
      const [x, y] = plan.pixelOf(map, point, canvas);
      await page.mouse.click(canvas.x + x, canvas.y + y);
    }
    await page.getByText(/3 picks fit, rms/).waitFor();
    await screenshot(page, "picking");
    const [, centimetres] = /rms ([\d.]+) cm/.exec(await page.locator(".fit").innerText());
    assert.ok(Number(centimetres) < 10, `rms error of ${centimetres} cm`);
    await page.getByRole("button", { name: "Save the registered map" }).click();
    await page.getByText(/Written: .*room-plan.byre/).waitFor();
    assert.equal(JSON.parse(outputOf("inspect", "room-plan.byre", "--json")).plan.plan, "room-plan.yaml");
    assert.match(readFileSync("room-plan.picks.csv", "utf8"), /^name,point,.*,plan_end_y_m\nplace 1,\d+,/);
    const registered = outputOf("register", "room.byre", "--plan", plan.file, "--points", "room-plan.picks.csv");
    assert.match(registered, /3/);
    assert.deepEqual(page.problems, []);
  });

  test("wrong points requires a confirmation of the residual to save", async () => {
    rmSync("wrong-plan.byre", { force: true });
    const plan = writePlan("room-plan");
    const page = await openMap({}, "--plan", plan.file, "-o", "wrong-plan.byre");
    const canvas = await page.locator("canvas.plan").boundingBox();
    const wrong = [[0.1, 0.1], [0.9, 0.85], [0.15, 0.9]];
    for (const [i, place] of [{ x: 0.2, y: 0.5 }, { x: 0.8, y: 0.6 }, { x: 0.35, y: 0.3 }].entries()) {
      await pickInMap(page, place);
      await page.mouse.click(canvas.x + wrong[i][0] * canvas.width, canvas.y + wrong[i][1] * canvas.height);
    }
    await page.getByText(/residual of the map \d+\.\d+ m/).waitFor();
    await page.getByRole("button", { name: "Save the registered map" }).click();
    const dialog = page.getByRole("dialog");
    assert.match(await dialog.innerText(), /residual of \d+\.\d+ m/);
    await screenshot(page, "confirm");
    await page.getByRole("button", { name: "Do not save" }).click();
    await dialog.waitFor({ state: "detached" });
    assert.ok(!existsSync("wrong-plan.byre"));
    await page.getByRole("button", { name: "Save the registered map" }).click();
    await page.getByRole("button", { name: "Save anyway" }).click();
    await page.getByText(/Written: .*wrong-plan.byre/).waitFor();
    assert.deepEqual(page.problems, []);
  });

  test("can be undone", async () => {
    const plan = writePlan("room-plan");
    const page = await openMap({ colorScheme: "dark" }, "--plan", plan.file);
    await pickInMap(page, { x: 0.4, y: 0.5 });
    await page.locator("canvas.plan").click({ position: { x: 150, y: 120 } });
    await page.getByRole("textbox", { name: "Name of pick 1" }).waitFor();
    await screenshot(page, "picking_dark");
    await page.getByRole("button", { name: "Remove place 1" }).click();
    assert.equal(await page.getByRole("textbox").count(), 0);
    assert.ok(await page.locator("#save").isDisabled());
  });
});

describe("A map of a million points", () => {
  test("is drawn", async (context) => {
    const count = 1_000_000;
    await openMap();
    const crowded = await browser.newPage();
    const body = crowdOf(count);
    await crowded.route("**/map/offline", (route) => route.fulfill({ body }));
    await crowded.route("**/map/greys", (route) => route.fulfill({ body: Buffer.alloc(count, 128) }));
    await crowded.goto(viewer.url);
    await eventually(async () => (await pointCount(crowded)) === count, () => "all points");
    const loaded = await crowded.evaluate(() => performance.now());
    const paint = await crowded.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
    await crowded.evaluate(() => window.byreFramesPerSecond(0.01)); // the first frame uploads the points
    const rate = await crowded.evaluate(() => window.byreFramesPerSecond(1));
    context.diagnostic(
      `first contentful paint after ${paint.toFixed(0)} ms, points after ${loaded.toFixed(0)} ms; ` +
        `${rate.toFixed(1)} frames per second, software rendering; ${((body.length + count) / 1e6).toFixed(0)} MB of points`,
    );
  });

  /** Binary message of a map with points on the walls of a hall. */
  function crowdOf(count) {
    const bytes = Buffer.alloc(8 + 13 * count);
    bytes.writeUInt32LE(count, 0);
    for (let i = 0; i < count; ++i) {
      const along = (i / count) * 2 * Math.PI;
      const place = [20 * Math.cos(along), 4 * ((i * 0.618) % 1), 8 * Math.sin(along)]; // y is up
      place.forEach((value, axis) => bytes.writeFloatLE(value, 8 + 12 * i + 4 * axis));
    }
    return bytes;
  }
});
