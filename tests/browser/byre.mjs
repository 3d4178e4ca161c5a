// Starts and stops byre and a browser.
import { spawn, spawnSync } from "node:child_process";
import axe from "axe-core";
import { chromium } from "playwright-core";

const kPatience = 60_000; // milliseconds

/** Process of byre that serves a page at its url until interrupted. */
export class Viewer {
  #process;
  #said = "";
  #exitCode;

  /** Starts "byre ARGUMENTS"; resolves when the address is printed. */
  static async start(...commandLine) {
    const viewer = new Viewer();
    viewer.#process = spawn(process.env.BYRE, commandLine, { stdio: ["ignore", "ignore", "pipe"] });
    viewer.#exitCode = new Promise((resolve) => viewer.#process.on("close", resolve));
    viewer.#process.stderr.on("data", (text) => (viewer.#said += text));
    await eventually(() => /viewer: (http\S+)/.test(viewer.#said), () => `an address in: ${viewer.#said}`);
    viewer.url = /viewer: (http\S+)/.exec(viewer.#said)[1];
    return viewer;
  }

  /** Calls look while byre is stopped, so that slow checks see one state. */
  async whileStopped(look) {
    this.#process.kill("SIGSTOP");
    const seen = await look();
    this.#process.kill("SIGCONT");
    return seen;
  }

  /** Sends SIGINT, as Ctrl-C; resolves to the exit code. */
  interrupt() {
    this.#process.kill("SIGINT");
    return this.#exitCode;
  }

  end() {
    this.#process.kill("SIGKILL");
  }
}

/** Standard output of "byre ARGUMENTS". Throws if it fails. */
export function outputOf(...commandLine) {
  const { status, stdout, stderr } = spawnSync(process.env.BYRE, commandLine, { encoding: "utf8" });
  if (status !== 0) throw new Error(`byre ${commandLine.join(" ")}: ${stderr}`);
  return stdout;
}

/**
 * Chromium with software rendering; "webgl: false" disables WebGL. Without the watchdog of the GPU process, which ends
 * slow rendering.
 */
export function startBrowser({ webgl = true } = {}) {
  const drawing = webgl ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] : ["--disable-3d-apis"];
  return chromium.launch({
    executablePath: process.env.BROWSER,
    args: ["--no-sandbox", "--use-gl=angle", "--disable-gpu-watchdog", ...drawing],
  });
}

/** Opens a page that collects console errors and exceptions in "problems". */
export async function openPage(browser, url, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1360, height: 820 }, colorScheme: "light", ...options });
  page.setDefaultTimeout(kPatience);
  page.problems = [];
  page.on("console", (message) => {
    if (message.type() === "error") page.problems.push(message.text());
  });
  page.on("pageerror", (error) => page.problems.push(String(error)));
  await page.goto(url);
  return page;
}

/** Saves the window as screenshots/NAME.png. */
export function screenshot(page, name) {
  return page.screenshot({ path: `screenshots/${name}.png` });
}

/** Violations of the rules of axe on the present page: rule and elements each. */
export async function accessibilityFaults(page) {
  await page.evaluate(axe.source);
  const { violations } = await page.evaluate(() => window.axe.run());
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(" ")}`);
}

/** Polls until isSo() holds. Throws after a minute; what: description of the condition, for the error. */
export async function eventually(isSo, what) {
  const end = Date.now() + kPatience;
  while (Date.now() < end) {
    if (await isSo()) return;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  throw new Error(`timeout: ${what()}`);
}
