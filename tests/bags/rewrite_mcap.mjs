// Rewrites the messages of an MCAP file with the reference writer of the format, and adds an attachment and metadata,
// which byre ignores.
// Usage: rewrite_mcap.mjs FROM TO

import {McapIndexedReader, McapWriter} from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import {readFileSync, writeFileSync} from "node:fs";

await zstd.isLoaded;
const bytes = readFileSync(process.argv[2]);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (begin, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(begin), Number(size)),
};
const decompressHandlers = {zstd: (packed, size) => zstd.decompress(packed, Number(size))};
const from = await McapIndexedReader.Initialize({readable, decompressHandlers});

const pieces = [];
let position = 0n;
const writable = {
  position: () => position,
  write: async (piece) => {
    pieces.push(Buffer.from(piece));
    position += BigInt(piece.length);
  },
};
const compressChunk = (data) => ({compression: "zstd", compressedData: zstd.compress(data)});
const to = new McapWriter({writable, compressChunk, chunkSize: 300000});
await to.start({profile: "ros2", library: "rewrite_mcap"});
await to.addMetadata({name: "site", metadata: new Map([["name", "barn"]])});
const channels = new Map();
for await (const message of from.readMessages()) {
  if (!channels.has(message.channelId)) {
    const {schemaId, topic, messageEncoding, metadata} = from.channelsById.get(message.channelId);
    const {name, encoding, data} = from.schemasById.get(schemaId);
    const schema = await to.registerSchema({name, encoding, data});
    channels.set(message.channelId, await to.registerChannel({schemaId: schema, topic, messageEncoding, metadata}));
  }
  await to.addMessage({...message, channelId: channels.get(message.channelId)});
}
const note = {name: "note", mediaType: "text/plain", data: new Uint8Array(1000), logTime: 0n, createTime: 0n};
await to.addAttachment(note);
await to.end();
writeFileSync(process.argv[3], Buffer.concat(pieces));
