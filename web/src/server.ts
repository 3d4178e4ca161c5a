import { decodeImage, decodeMap, type MapData, type SeenImage } from "./decode";
import type {
  EventFields,
  LiveMessage,
  Pick,
  PicturePixel,
  PlanFit,
  Proposal,
  RegistryScene,
  ReviewAct,
  SceneFields,
  SiteFields,
  SiteSummary,
  VersionFields,
} from "./types";

export const kRetryMilliseconds = 2000;
export const kUnavailable = 503; // status while the server has no connection to the registry
const kWaitMilliseconds = 300;

/** URL of a path below the page, with its token. */
export function address(path: string): string {
  const token = new URLSearchParams(location.search).get("token");
  const below = location.pathname.replace(/\/[^/]*$/, "") + path;
  return token === null ? below : `${below}?token=${encodeURIComponent(token)}`;
}

/** Answer of the server other than success. */
export class Refusal extends Error {
  readonly status: number;
  constructor(status: number, problem: string) {
    super(problem);
    this.status = status;
  }
}

async function answerOf(response: Response): Promise<Response> {
  if (response.ok) return response;
  throw new Refusal(response.status, problemIn(await response.text()));
}

async function get<Answer>(path: string): Promise<Answer> {
  return (await answerOf(await fetch(address(path)))).json();
}

function problemIn(text: string): string {
  try {
    return JSON.parse(text).problem ?? text;
  } catch {
    return text;
  }
}

async function post<Answer>(path: string, content: unknown): Promise<Answer> {
  const response = await fetch(address(path), { method: "POST", body: JSON.stringify(content) });
  return (await answerOf(response)).json();
}

/** notify: called while the server prepares the scene, with what it does. */
export async function loadScene(notify: (text: string) => void): Promise<SceneFields | RegistryScene> {
  const scene = await get<SceneFields | RegistryScene | { waiting: string }>("/scene");
  if (!("waiting" in scene)) return scene;
  notify(scene.waiting);
  await new Promise((resolve) => setTimeout(resolve, kWaitMilliseconds));
  return loadScene(notify);
}

export function loadSites(): Promise<SiteSummary[]> {
  return get("/sites");
}

export function loadSite(site: string): Promise<SiteFields> {
  return get(`/sites/${encodeURIComponent(site)}`);
}

export function loadEvents(site: string): Promise<EventFields[]> {
  return get(`/sites/${encodeURIComponent(site)}/events`);
}

export function loadVersion(site: string, version: string): Promise<VersionFields> {
  return get(`/sites/${encodeURIComponent(site)}/${version}`);
}

export function review(site: string, version: string, act: ReviewAct, reason: string): Promise<unknown> {
  return post(`/sites/${encodeURIComponent(site)}/${version}/${act}`, { reason });
}

export async function loadMap(which: "offline" | "online" | "changes"): Promise<MapData> {
  return decodeMap(await (await answerOf(await fetch(address(`/map/${which}`)))).arrayBuffer());
}

/** Grey value of each point of the map. */
export async function loadGreys(): Promise<Uint8Array> {
  return new Uint8Array(await (await answerOf(await fetch(address("/map/greys")))).arrayBuffer());
}

/** Image of the frame, or of the nearest frame with a stored image. */
export async function loadImage(frame: number): Promise<SeenImage> {
  return decodeImage(await (await answerOf(await fetch(address(`/images/${frame}`)))).arrayBuffer());
}

export function register(picks: Pick[]): Promise<PlanFit> {
  return post("/registration", { picks });
}

/** Matches the walls of the map with the plan; takes seconds. */
export function propose(): Promise<Proposal> {
  return post("/proposal", {});
}

/** Further pictures of the place at a pixel, the best to triangulate by first. */
export async function furtherViews(pixel: PicturePixel): Promise<PicturePixel[]> {
  return (await post<{ views: PicturePixel[] }>("/place", { pixels: [pixel] })).views;
}

/** Standard deviation of the place seen at pixels of several pictures, map units. Throws if they are of different places. */
export async function sigmaOfPlace(pixels: PicturePixel[]): Promise<number> {
  return (await post<{ sigma: number }>("/place", { pixels })).sigma;
}

/**
 * Saves the registered map. picks: null for the proposal. accepted: residual confirmed by the user, metres. Returns the
 * files written.
 */
export async function save(picks: Pick[] | null, accepted?: number): Promise<string[]> {
  const what = picks ? { picks } : { proposal: true };
  return (await post<{ written: string[] }>("/save", { ...what, accepted_residual_m: accepted })).written;
}

export interface LiveListener {
  /** New connection: the server sends the whole run again. */
  opened(): void;
  received(message: LiveMessage): void;
  sawImage(image: SeenImage): void;
  /** Connection lost; it is retried every kRetryMilliseconds. */
  lost(): void;
}

/** Receives the messages of a run until the page is closed. */
export function listen(listener: LiveListener): void {
  const url = new URL(address("/live"), location.href);
  url.protocol = "ws:";
  const socket = new WebSocket(url);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => listener.opened();
  socket.onmessage = ({ data }) => {
    if (typeof data === "string") listener.received(JSON.parse(data));
    else listener.sawImage(decodeImage(data));
  };
  socket.onclose = () => {
    listener.lost();
    setTimeout(() => listen(listener), kRetryMilliseconds);
  };
}
