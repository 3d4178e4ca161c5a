import { decodeImage, decodeMap, type MapData, type SeenImage } from "./decode";
import type { LiveMessage, Pick, PlanFit, SceneFields } from "./types";

const kRetryMilliseconds = 2000;

/** A path on the server, with the token that this page was opened with. */
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

export async function loadMap(which: "offline" | "online"): Promise<MapData> {
  return decodeMap(await (await answerOf(await fetch(address(`/map/${which}`)))).arrayBuffer());
}

/** Of the frame or, where that was not kept, of one near it. */
export async function loadImage(frame: number): Promise<SeenImage> {
  return decodeImage(await (await answerOf(await fetch(address(`/images/${frame}`)))).arrayBuffer());
}

export function register(picks: Pick[]): Promise<PlanFit> {
  return post("/registration", { picks });
}

/** Gives the names of the files written. The residual is what somebody was told and accepts, in metres. */
export async function save(picks: Pick[], accepted?: number): Promise<string[]> {
  return (await post<{ written: string[] }>("/save", { picks, accepted_residual_m: accepted })).written;
}

export interface LiveListener {
  /** A connection begins: everything is told from the start. */
  opened(): void;
  told(message: LiveMessage): void;
  sawImage(image: SeenImage): void;
  /** It was lost, and is tried again now and then. */
  lost(): void;
}

/** Listens to a run until the page is left. */
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
