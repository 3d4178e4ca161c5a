// Foxglove clients of a run. BYRE: path of the program; the folder "room" is a recording.

import assert from "node:assert";
import {spawn} from "node:child_process";
import {readFileSync} from "node:fs";
import test, {after, before} from "node:test";
import zstd from "@foxglove/wasm-zstd";
import {McapIndexedReader} from "@mcap/core";
import {WebSocket} from "ws";
import {Watcher, eventually} from "./watcher.mjs";

const kRecord = "record.mcap";
let said = "", byre, exit, url, watcher, late;

// Messages of the record by topic and time.
async function recorded() {
  await zstd.isLoaded;
  const bytes = readFileSync(kRecord);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (begin, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(begin), Number(size)),
  };
  const decompressHandlers = {zstd: (packed, size) => zstd.decompress(packed, Number(size))};
  const file = await McapIndexedReader.Initialize({readable, decompressHandlers});
  const messages = new Map();
  for await (const {channelId, logTime, data} of file.readMessages()) {
    const key = `${file.channelsById.get(channelId).topic} ${logTime}`;
    messages.set(key, [...(messages.get(key) ?? []), Buffer.from(data)]);
  }
  const schemas = new Map([...file.channelsById.values()].map(({topic, schemaId}) =>
    [topic, new TextDecoder().decode(file.schemasById.get(schemaId).data)]));
  return {messages, schemas, topics: [...schemas.keys()].sort()};
}

before(async () => {
  byre = spawn(process.env.BYRE, ["run", "room", "--pace", "live", "--view", "0", "--view-for", "3600",
    "--record", kRecord, "--record-images"], {stdio: ["ignore", "ignore", "pipe"]});
  exit = new Promise((resolve) => byre.on("close", resolve));
  byre.stderr.on("data", (text) => (said += text));
  await eventually(() => /viewer: (http\S+)/.test(said), () => `an address in: ${said}`);
  url = /viewer: (http\S+)/.exec(said)[1].replace("http", "ws");

  watcher = await Watcher.connect(url, () => true);
  const slow = new WebSocket(url, ["foxglove.sdk.v1"]);  // subscribes to all topics, never reads
  slow.on("error", () => {});
  slow.on("open", () => {
    const subscriptions = [...Array(13).keys()].map((id) => ({id, channelId: id}));
    slow.send(JSON.stringify({op: "subscribe", subscriptions}));
    slow.pause();
  });
  await eventually(() => said.includes("viewer: stays"), () => `the end of the run in: ${said}`);
  await eventually(() => watcher.messages.get("/diagnostics").length > 0, () => "diagnostics");
  const last = watcher.messages.get("/diagnostics").at(-1).time;
  const hasMap = (each) => each.messages.get("/byre/points").at(-1)?.time >= last;
  await eventually(() => hasMap(watcher), () => "the final map");
  late = await Watcher.connect(url, (topic) => topic.includes("points") || topic.startsWith("/tf"));
  await eventually(() => hasMap(late) && late.messages.get("/tf_static").length > 0, () => "the latched messages");
});

after(() => byre.kill("SIGKILL"));

test("the server announces its name and capabilities", () => {
  assert.match(watcher.info.name, /^byre /);
  assert.deepEqual(watcher.info.capabilities, ["time"]);
  assert.equal(watcher.info.sessionId, late.info.sessionId);
  assert.deepEqual(watcher.problems, []);
  assert.deepEqual(watcher.statuses, []);
});

test("messages and schemas equal the record byte by byte", async () => {
  const {messages, schemas, topics} = await recorded();
  assert.deepEqual([...watcher.channels.keys()].sort(), topics);
  let compared = 0;
  for (const [topic, received] of watcher.messages) {
    assert.equal(watcher.channels.get(topic).schema, schemas.get(topic));
    assert.equal(watcher.channels.get(topic).encoding, "cdr");
    const isPaced = topic === "/byre/path" || topic === "/byre/points";  // sent at a limited rate
    for (const {time, data} of isPaced ? received.slice(-1) : received) {
      const expected = messages.get(`${topic} ${time}`);
      assert.ok(expected?.some((bytes) => bytes.equals(data)), `${topic} at ${time}`);
      ++compared;
    }
  }
  assert.ok(compared > 20, `${compared} messages`);
});

test("messages of each topic decode to the expected content", () => {
  for (const topic of ["/tf", "/tf_static", "/byre/odometry", "/byre/pose", "/byre/path", "/diagnostics", "/byre/points",
    "/left/image_raw", "/left/camera_info", "/right/image_raw", "/right/camera_info"]) {
    assert.ok(watcher.decoded(topic).length > 0, topic);
  }
  assert.equal(watcher.decoded("/byre/pose")[0].header.frame_id, "map");
  const cloud = watcher.decoded("/byre/points").at(-1);
  assert.ok(cloud.width > 100 && cloud.data.length === cloud.width * cloud.point_step);
  const image = watcher.decoded("/left/image_raw")[0];
  assert.equal(image.data.length, image.height * image.step);
  const children = new Set([...watcher.decoded("/tf"), ...watcher.decoded("/tf_static")]
    .flatMap(({transforms}) => transforms.map((each) => each.child_frame_id)));
  assert.deepEqual([...children].sort(), ["base_link", "left_camera", "odom", "right_camera"]);
});

test("times equal those of the frames", async () => {
  const {messages} = await recorded(); // all frames: times are sent without subscription
  assert.ok(watcher.times.length > 5);
  for (const time of watcher.times) assert.ok(messages.has(`/diagnostics ${time}`), String(time));
});

test("a client after the run receives the latched messages only", () => {
  assert.equal(late.messages.get("/byre/points").length, 1);
  assert.deepEqual(late.messages.get("/byre/points")[0], watcher.messages.get("/byre/points").at(-1));
  assert.deepEqual(late.messages.get("/tf_static"), watcher.messages.get("/tf_static"));
  assert.deepEqual(late.messages.get("/tf"), []);
});

test("a client with both protocols gets the newer one, and invalid messages are answered", async () => {
  const socket = new WebSocket(url, ["foxglove.websocket.v1", "foxglove.sdk.v1"]);
  const texts = [];
  socket.on("message", (data) => texts.push(JSON.parse(data)));
  await new Promise((resolve) => socket.on("open", resolve));
  assert.equal(socket.protocol, "foxglove.sdk.v1");
  socket.send("{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":-1}]}");
  socket.send(Buffer.from([1, 2, 3]));
  await eventually(() => texts.filter(({op}) => op === "status").length === 2, () => "two answers");
  assert.ok(texts.filter(({op}) => op === "status").every(({level}) => level === 2));
  socket.close();
});

test("other pages and other protocols are rejected", async () => {
  const fails = (protocols, options) => new Promise((resolve) => {
    const socket = new WebSocket(url, protocols, options);
    socket.on("error", () => resolve(true));
    socket.on("open", () => resolve(false));
  });
  assert.ok(await fails(["foxglove.sdk.v1"], {origin: "https://elsewhere.example"}));
  assert.ok(await fails(["another.protocol"], {}));
  assert.ok(!await fails(["foxglove.sdk.v1"], {origin: "https://app.foxglove.dev"}));
});

test("Ctrl-C ends byre with connected clients", async () => {
  byre.kill("SIGINT");
  assert.equal(await exit, 0);
});
