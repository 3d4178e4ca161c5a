import { decodeImage, decodeMap, type MapData, type SeenImage } from "./decode";
import type { LiveMessage, Pick, PicturePixel, PlanFit, Proposal, SceneFields } from "./types";

const kRetryMilliseconds = 2000;

/** URL of a path on the server, with this page's token. */
export function address(path: string): string {
  const token = new URLSearchParams(location.search).get("token");
  return token === null ? path : `${path}?token=${encodeURIComponent(token)}`;
}

async function answerOf(response: Response): Promise<Response> {
  if (response.ok) return response;
  const said = await response.text();
  throw new Error(problemIn(said));
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

export async function loadScene(): Promise<SceneFields> {
  return (await answerOf(await fetch(address("/scene")))).json();
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
  told(message: LiveMessage): void;
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
    if (typeof data === "string") listener.told(JSON.parse(data));
    else listener.sawImage(decodeImage(data));
  };
  socket.onclose = () => {
    listener.lost();
    setTimeout(() => listen(listener), kRetryMilliseconds);
  };
}
