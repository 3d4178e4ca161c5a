// Versions of maps in a registry are reviewed in the browser.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { after, afterEach, before, beforeEach, describe, test } from "node:test";
import { accessibilityFaults, eventually, openPage, outputOf, screenshot, startBrowser, Viewer } from "./byre.mjs";

const kOwner = process.env.PGUSER;

let browser;
let viewer;
beforeEach(async () => (browser = await startBrowser()));
afterEach(async () => {
  await browser.close();
  viewer?.end();
});

/** "byre registry ARGUMENTS" of an account. */
function registry(account, ...commandLine) {
  process.env.PGUSER = account;
  return outputOf("registry", ...commandLine);
}

function server(action) {
  const { status, stderr } = spawnSync(process.env.REGISTRY_SCRIPT, [process.env.REGISTRY, action], { encoding: "utf8" });
  assert.equal(status, 0, stderr);
}

const idOf = (map) => outputOf("history", map).slice(0, 16);
const stateOf = (id) => JSON.parse(registry("ann", "show", "barn", id, "--json")).state;

async function open(account, fragment = "", options = {}) {
  process.env.PGUSER = account;
  viewer = await Viewer.start("registry", "serve", "--port", "0");
  return openPage(browser, viewer.url + fragment, options);
}

async function review(page, act, reason) {
  await page.getByLabel(/^Reason/).fill(reason);
  await page.getByRole("button", { name: act }).click();
  await page.getByRole("dialog").getByRole("button", { name: act }).click();
}

// The tests are in order: each begins with the state that the one before left.
describe("A registry of maps", () => {
  const [first, updated, part] = ["barn_1.byre", "updated.byre", "updated_by_part.byre"].map(idOf);

  before(() => {
    registry(kOwner, "init", "barn");
    registry(kOwner, "admit", "ann", "reviewer");
    registry(kOwner, "admit", "robot_1", "robot", "--site", "barn");
    registry("ann", "push", "barn", "barn_1.byre", "--note", "by day");
    registry("ann", "accept", "barn", first, "--reason", "the first");
    registry("ann", "push", "barn", "updated.byre", "updated_by_part.byre", "--note", "Dark");
  });
  after(() => (process.env.PGUSER = kOwner));

  test("has its versions compared, accepted and rejected with reasons", async () => {
    const page = await open("ann");
    await page.getByText("Account ann").waitFor();
    assert.deepEqual(await accessibilityFaults(page), []);
    await page.getByRole("link", { name: "barn", exact: true }).click();
    const proposed = page.getByRole("row").filter({ hasText: "proposed" });
    await eventually(async () => (await proposed.count()) >= 2, () => "proposed versions");
    assert.deepEqual(await accessibilityFaults(page), []);
    await page.getByRole("link", { name: updated }).first().click();
    await page.getByRole("link", { name: "Show the map and its changes" }).click();
    const added = page.getByRole("button", { name: /Added points: \d+/ });
    await added.waitFor();
    const { points } = JSON.parse(outputOf("diff", "barn_1.byre", "updated.byre", "--json"));
    assert.equal(Number(/\d+/.exec(await added.innerText())[0]), points.added);
    await page.getByRole("button", { name: "Next picture" }).click();
    await eventually(
      () => page.evaluate(() => document.querySelector("figure.keyframe-picture img").naturalWidth > 100),
      () => "a picture",
    );
    await screenshot(page, "registry_map");
    await page.getByRole("link", { name: "Back to the review" }).click();

    const accept = page.getByRole("button", { name: "Accept" });
    await accept.click();
    await page.getByText("Give a reason first.").waitFor();
    await page.getByLabel(/^Reason/).fill("<b>looks right</b>");
    await accept.click();
    await page.getByText(`Accept version ${updated} for all robots of barn?`).waitFor();
    await page.getByRole("button", { name: "Cancel" }).click();
    assert.equal(stateOf(updated), "proposed");
    await accept.press("Enter");
    await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    await page.getByText(`Accepted: ${updated}`).waitFor();
    await page.getByText(`version ${updated} is not proposed`).first().waitFor();
    assert.ok(await accept.isDisabled());
    assert.equal(stateOf(updated), "accepted");
    await screenshot(page, "registry_version");
    assert.deepEqual(await accessibilityFaults(page), []);

    await page.getByRole("link", { name: "barn", exact: true }).click();
    await page.getByRole("link", { name: part }).first().click();
    await page.getByText(`version ${part} was not made of ${updated}, which is accepted`).waitFor();
    assert.ok(await accept.isDisabled());
    await review(page, "Reject", "the gate is missing");
    await page.getByText(`Rejected: ${part}`).waitFor();
    await page.getByRole("link", { name: "barn", exact: true }).click();
    const history = page.getByRole("region", { name: "History" });
    for (const reason of ["<b>looks right</b>", "the gate is missing"]) await history.getByText(reason).waitFor();
    await page.screenshot({ path: "screenshots/registry_site.png", fullPage: true });
    assert.deepEqual(page.problems, []);
  });

  test("shows changes while a reason is entered", async () => {
    const page = await open("ann", `#site=barn&version=${updated}`);
    const reason = page.getByLabel(/^Reason/);
    await reason.fill("robots get lost");
    await page.getByText(`Accepts ${first} again`).waitFor();
    registry("ann", "rollback", "barn", "--reason", "by the command line");
    await page.getByText("by the command line").first().waitFor();
    assert.equal(await reason.inputValue(), "robots get lost");
    await review(page, "Roll back", "robots were not lost");
    await page.getByText(`Accepted: ${updated}`).waitFor();
    assert.equal(stateOf(updated), "accepted");
    assert.deepEqual(page.problems, []);
  });

  test("has no buttons for a robot, with the reason in German, on a narrow screen", async () => {
    const page = await open("robot_1", `#site=barn&version=${updated}`, {
      locale: "de-DE",
      colorScheme: "dark",
      viewport: { width: 390, height: 800 },
    });
    await page.getByText(/Keine Berechtigung für die Funktion accept, Konto robot_1/).waitFor();
    for (const name of ["Annehmen", "Ablehnen", "Zurücksetzen"]) {
      assert.ok(await page.getByRole("button", { name }).isDisabled());
    }
    await page.getByText("Dark", { exact: true }).waitFor(); // a note is not translated
    assert.deepEqual(await accessibilityFaults(page), []);
    await page.screenshot({ path: "screenshots/registry_narrow.png", fullPage: true });
    await page.getByRole("link", { name: "barn", exact: true }).click();
    await page.getByRole("region", { name: "Roboter" }).getByText("nie", { exact: true }).waitFor();
    assert.deepEqual(await accessibilityFaults(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "only the sheet scrolls");
    assert.deepEqual(page.problems, []);
  });

  test("shows a map on the current plan of its site", async () => {
    const files = ["--plan", "barn_1/plan/plan.yaml", "--points", "barn_1/plan/picks.csv", "-o", "on_plan.byre"];
    outputOf("register", "barn_1.byre", ...files);
    registry("ann", "push", "barn", "on_plan.byre", "--plan", "barn_1/plan/plan.yaml", "--name", "ground");
    const page = await open("ann", "#site=barn");
    const plans = page.getByRole("region", { name: "Floor plans" });
    await plans.getByRole("row").filter({ hasText: "ground 1" }).getByText("plan.yaml").waitFor();
    assert.deepEqual(await accessibilityFaults(page), []);
    await page.getByRole("link", { name: idOf("on_plan.byre") }).first().click();
    await page.getByRole("link", { name: "Show the map" }).click();
    await page.getByText(/^Floor plan ground 1 \(plan.yaml\), added by ann at 20/).waitFor();
    const loaded = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name));
    assert.ok(loaded.some((name) => name.includes("/plan.png")), "the picture of the plan");
    await screenshot(page, "registry_plan");
    assert.deepEqual(await accessibilityFaults(page), []);
    assert.deepEqual(page.problems, []);
  });

  test("explains what it lacks", async () => {
    const page = await open("ann", "#site=bran");
    await page.getByText(/has no site 'bran', or the account may not see it \(did you mean 'barn'\?\)/).waitFor();
    await page.getByRole("link", { name: "All sites" }).click();
    await page.getByRole("link", { name: "barn", exact: true }).waitFor();
    assert.equal(await page.getByText(/has no site/).count(), 0);
  });

  test("reports a lost connection and reconnects", async () => {
    const page = await open("ann", "#site=barn");
    await page.getByRole("link", { name: updated }).first().waitFor();
    server("kill");
    const lost = page.getByText("No connection to the registry; reconnecting");
    await lost.waitFor();
    await page.getByText(/^registry .*: /).waitFor();
    server("start");
    await lost.waitFor({ state: "detached" });
    await page.getByRole("link", { name: updated }).first().waitFor();
    assert.equal(await page.getByText(/^registry .*: /).count(), 0);
  });
});
