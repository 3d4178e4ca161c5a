// Reads an MCAP file with the reference reader of the format, by index and sequentially. Decodes all messages by the
// definitions in the file.

import {McapIndexedReader, McapStreamReader} from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import {parse} from "@foxglove/rosmsg";
import {MessageReader} from "@foxglove/rosmsg2-serialization";
import {readFileSync} from "node:fs";

await zstd.isLoaded;
const decompressHandlers = {zstd: (packed, size) => zstd.decompress(packed, Number(size))};

// Counts messages sequentially and verifies checksums.
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

// Contents of the file by topic: type, whether its quality of service is stated, and all messages decoded.
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
