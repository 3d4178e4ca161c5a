// Reads an MCAP file with the reader of those who made the format, by its index and from front to back, and decodes
// every message by the definition in the file.

import {McapIndexedReader, McapStreamReader} from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import {parse} from "@foxglove/rosmsg";
import {MessageReader} from "@foxglove/rosmsg2-serialization";
import {readFileSync} from "node:fs";

await zstd.isLoaded;
const decompressHandlers = {zstd: (packed, size) => zstd.decompress(packed, Number(size))};

// Messages counted from front to back; checksums are compared.
function streamed(bytes) {
  const reader = new McapStreamReader({decompressHandlers, validateCrcs: true});
  reader.append(bytes);
  let profile = "", messages = 0;
  for (let record; (record = reader.nextRecord());) {
    if (record.type === "Header") profile = record.profile;
    if (record.type === "Message") ++messages;
  }
  return {profile, messages, isDone: reader.done()};
}

// What the file holds: by topic its type, whether its quality of service is told, and all messages decoded.
export async function readMcap(file) {
  const bytes = readFileSync(file);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (begin, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(begin), Number(size)),
  };
  const indexed = await McapIndexedReader.Initialize({readable, decompressHandlers});
  const topics = {};
  let last = 0n, isAscending = true;
  for await (const {channelId, logTime, data} of indexed.readMessages()) {
    const {topic, schemaId, metadata} = indexed.channelsById.get(channelId);
    const schema = indexed.schemasById.get(schemaId);
    topics[topic] ??= {
      type: schema.name, hasQos: metadata.has("offered_qos_profiles"), messages: [],
      reader: new MessageReader(parse(new TextDecoder().decode(schema.data), {ros2: true})),
    };
    topics[topic].messages.push(topics[topic].reader.readMessage(data));
    isAscending &&= logTime >= last;
    last = logTime;
  }
  return {streamed: streamed(bytes), counted: Number(indexed.statistics.messageCount), isAscending, topics,
    compressions: [...new Set(indexed.chunkIndexes.map((chunk) => chunk.compression))]};
}
