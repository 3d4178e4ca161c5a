// Client of byre, based on the reference client of Foxglove's protocol.

import protocol from "@foxglove/ws-protocol";
import {parse} from "@foxglove/rosmsg";
import {MessageReader} from "@foxglove/rosmsg2-serialization";
import {WebSocket} from "ws";

const kPatience = 120_000; // milliseconds

/** Polls until isSo() holds. Throws after two minutes; what: description of the condition, for the error. */
export async function eventually(isSo, what) {
  const end = Date.now() + kPatience;
  while (Date.now() < end) {
    if (isSo()) return;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  throw new Error(`timeout: ${what()}`);
}

/** Client that stores everything it receives. */
export class Watcher {
  channels = new Map();   // by topic
  messages = new Map();   // by topic: {time, data}
  statuses = [];
  times = [];
  problems = [];

  /** wanted: whether a topic is subscribed. */
  static async connect(url, wanted) {
    const watcher = new Watcher();
    const socket = new WebSocket(url, [protocol.FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
    const client = new protocol.FoxgloveClient({ws: socket});
    watcher.client = client;
    const topics = new Map(); // by subscription id
    client.on("error", (error) => watcher.problems.push(String(error)));
    client.on("serverInfo", (info) => (watcher.info = info));
    client.on("status", (status) => watcher.statuses.push(status));
    client.on("time", ({timestamp}) => watcher.times.push(timestamp));
    client.on("advertise", (channels) => {
      for (const channel of channels) {
        watcher.channels.set(channel.topic, channel);
        watcher.messages.set(channel.topic, []);
        if (wanted(channel.topic)) topics.set(client.subscribe(channel.id), channel.topic);
      }
    });
    client.on("message", ({subscriptionId, timestamp, data}) => {
      watcher.messages.get(topics.get(subscriptionId)).push({time: timestamp, data: new Uint8Array(
        data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength))});
    });
    await eventually(() => watcher.info && watcher.channels.size > 0, () => `a server at ${url}`);
    return watcher;
  }

  /** Messages of a topic, decoded by the advertised schema. */
  decoded(topic) {
    const {schema} = this.channels.get(topic);
    const reader = new MessageReader(parse(schema, {ros2: true}));
    return this.messages.get(topic).map(({data}) => reader.readMessage(data));
  }

  close() {
    this.client.close();
  }
}
