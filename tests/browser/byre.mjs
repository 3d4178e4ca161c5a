// Starts byre and a browser, and ends both.
import { spawn, spawnSync } from "node:child_process";
import { chromium } from "playwright-core";

const kPatience = 60_000; // milliseconds

/** A byre that serves a page, at its url, until it is interrupted. */
export class Viewer {
  #process;
  #said = "";
  #exitCode;

  /** Starts "byre ARGUMENTS"; resolves once it serves. */
  static async start(...commandLine) {
    const viewer = new Viewer();
    viewer.#process = spawn(process.env.BYRE, commandLine, { stdio: ["ignore", "ignore", "pipe"] });
    viewer.#exitCode = new Promise((resolve) => viewer.#process.on("close", resolve));
    viewer.#process.stderr.on("data", (text) => (viewer.#said += text));
    await eventually(() => /viewer: (http\S+)/.test(viewer.#said), () => `an address in: ${viewer.#said}`);
    viewer.url = /viewer: (http\S+)/.exec(viewer.#said)[1];
    return viewer;
  }

  /** Nothing moves while it is looked at, however slowly that goes. */
  async whileStopped(look) {
    this.#process.kill("SIGSTOP");
    const seen = await look();
    this.#process.kill("SIGCONT");
    return seen;
  }

  /** As Ctrl-C does; gives the exit code. */
  interrupt() {
    this.#process.kill("SIGINT");
    return this.#exitCode;
  }

  end() {
    this.#process.kill("SIGKILL");
  }
}

/** What "byre ARGUMENTS" prints. */
export function outputOf(...commandLine) {
  const { status, stdout, stderr } = spawnSync(process.env.BYRE, commandLine, { encoding: "utf8" });
  if (status !== 0) throw new Error(`byre ${commandLine.join(" ")}: ${stderr}`);
  return stdout;
}

/**
 * Chromium that draws without a graphics card; with "webgl: false" it draws nothing in three dimensions. No watchdog ends
 * it where that takes long.
 */
export function startBrowser({ webgl = true } = {}) {
  const drawing = webgl ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] : ["--disable-3d-apis"];
  return chromium.launch({
    executablePath: process.env.BROWSER,
    args: ["--no-sandbox", "--use-gl=angle", "--disable-gpu-watchdog", ...drawing],
  });
}

/** A page that remembers what went wrong in it, in "problems". */
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

/** Waits until it is so; what: gives what was waited for, for the error. */
export async function eventually(isSo, what) {
  const end = Date.now() + kPatience;
  while (Date.now() < end) {
    if (await isSo()) return;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  throw new Error(`waited in vain for ${what()}`);
}
