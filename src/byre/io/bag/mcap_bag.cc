#include "byre/io/bag/mcap_bag.h"

#include "byre/base/byte_stream.h"
#include "byre/input_error.h"

#include <algorithm>
#include <utility>

#include <zlib.h>

namespace byre {
namespace {

constexpr std::uint64_t kMaxSchemaBytes = 16u << 20;  // bytes of a schema or a channel

}  // namespace

McapBag::McapBag(std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted, const BagLimits& limits)
    : ChunkedBag("mcap", std::move(source), std::move(place), std::move(wanted), limits) {
  const std::vector<std::byte> magic = read_piece(file(), 0, kMcapMagic.size());
  if (!std::ranges::equal(magic, kMcapMagic)) {
    throw InputError(this->place(), "does not begin with the MCAP magic", "use a copy, or record again");
  }
  const std::uint64_t end = file().size();
  const std::uint64_t stop = scan({file(), kMcapMagic.size(), end});
  if (unknown_messages_ > 0) {
    add_damage(std::to_string(unknown_messages_) + " messages belong to undeclared channels");
  }
  if (!is_closed_)
    add_damage(stop == end ? "was not closed: only the end of the data section is missing"
                           : truncation_text(stop, end));
  finish_scan();
}

std::uint64_t McapBag::scan(const Region& region) {
  const bool is_file = !region.is_chunk;
  std::uint64_t begin = region.begin;
  while (begin < region.end && !(is_file && is_closed_)) {
    const std::vector<std::byte> head = read_piece(region.source, begin, kMcapRecordHead);
    if (head.size() < kMcapRecordHead || region.end - begin < kMcapRecordHead) break;
    ByteReader reader(head, place(), begin);
    const auto kind = reader.read<std::uint8_t>();
    const auto size = reader.read<std::uint64_t>();
    const std::uint64_t content = begin + kMcapRecordHead, left = region.end - content;
    const bool is_chunk = is_file && kind == static_cast<std::uint8_t>(McapRecord::chunk);
    if (kind == 0 || (size > left && !is_chunk)) break;
    try {
      take_record(static_cast<McapRecord>(kind), content, std::min(size, left), region);
    } catch (const InputError& error) {
      add_broken(begin, "cannot be read: " + error.reason());
    }
    if (size > left) break;  // a truncated chunk, whose beginning was read
    begin = content + size;
  }
  return begin;
}

void McapBag::take_record(McapRecord kind, std::uint64_t begin, std::uint64_t size, const Region& region) {
  ByteSource& source = region.source;
  switch (kind) {
    case McapRecord::schema:
      return take_schema(read_piece(source, begin, std::min(size, kMaxSchemaBytes)), begin);
    case McapRecord::channel:
      return take_channel(read_piece(source, begin, std::min(size, kMaxSchemaBytes)), begin);
    case McapRecord::message:
      return take_message(begin, size, region);
    case McapRecord::chunk:
      if (!region.is_chunk) take_chunk(begin, size);  // chunks are not nested
      return;
    case McapRecord::data_end:
      if (!region.is_chunk) is_closed_ = true;
      return;
    default:  // unused records, and those of later versions
      return;
  }
}

McapBag::Chunk McapBag::chunk_of(std::uint64_t begin, std::uint64_t size) {
  constexpr std::size_t kLongestName = 16;
  const std::vector<std::byte> head =
      read_piece(file(), begin, std::min<std::uint64_t>(size, kMcapChunkHead + 4 + kLongestName + 8));
  ByteReader reader(head, place(), begin);
  reader.take(2 * sizeof(std::uint64_t));
  Chunk chunk;
  chunk.piece.original_size = reader.read<std::uint64_t>();
  chunk.checksum = reader.read<std::uint32_t>();
  const std::optional<Compression> compression = parse_compression(reader.read_text());
  chunk.is_supported = compression.has_value();
  chunk.piece.compression = compression.value_or(Compression::none);
  const auto stated_size = reader.read<std::uint64_t>();
  const std::uint64_t before = head.size() - reader.remaining();
  chunk.piece.begin = begin + before;
  chunk.piece.size = std::min(stated_size, size - before);
  return chunk;
}

CompressedPiece McapBag::piece_at(std::uint64_t chunk) {
  const std::vector<std::byte> head = read_piece(file(), chunk, kMcapRecordHead);
  ByteReader reader(head, place(), chunk);
  reader.read<McapRecord>();
  const auto size = reader.read<std::uint64_t>();
  const std::uint64_t content = chunk + kMcapRecordHead;
  return chunk_of(content, std::min(size, file().size() - content)).piece;
}

void McapBag::take_chunk(std::uint64_t begin, std::uint64_t size) {
  const std::uint64_t record = begin - kMcapRecordHead;
  const Chunk chunk = chunk_of(begin, size);
  const CompressedPiece& piece = chunk.piece;
  if (!chunk.is_supported) return add_broken(record, "has an unsupported compression");
  add_compression(piece.compression);
  if (piece.compression == Compression::none) {
    const std::uint64_t end = piece.begin + piece.size;
    if (scan({file(), piece.begin, end, true}) < end) add_broken(record, "ends in the middle of a message");
    return;
  }
  const std::optional<Decompressed> chunk_content = scan_piece(piece);
  if (!chunk_content) return;
  const bool is_matched = chunk.checksum == 0 || mcap_checksum(chunk_content->bytes) == chunk.checksum;
  if (chunk_content->is_whole && !is_matched) return add_broken(record, "has a wrong checksum");
  MemorySource source(chunk_content->bytes);
  const bool is_complete = scan({source, 0, source.size(), true, record}) == source.size();
  if (!chunk_content->is_whole || !is_complete) add_broken(record, "cannot be decompressed completely");
}

void McapBag::take_schema(std::span<const std::byte> bytes, std::uint64_t begin) {
  ByteReader reader(bytes, place(), begin);
  const auto id = reader.read<std::uint16_t>();
  schemas_[id] = reader.read_text();
}

void McapBag::take_channel(std::span<const std::byte> bytes, std::uint64_t begin) {
  ByteReader reader(bytes, place(), begin);
  const auto id = reader.read<std::uint16_t>();
  const auto schema = schemas_.find(reader.read<std::uint16_t>());
  const std::string topic = reader.read_text();
  const std::string encoding = reader.read_text();
  channels_[id] = topic_number(topic, schema == schemas_.end() ? std::string() : schema->second, encoding);
}

void McapBag::take_message(std::uint64_t begin, std::uint64_t size, const Region& region) {
  const std::vector<std::byte> head = read_piece(region.source, begin, std::min<std::uint64_t>(size, kMcapMessageHead));
  ByteReader reader(head, place(), begin);
  const auto channel = channels_.find(reader.read<std::uint16_t>());
  reader.read<std::uint32_t>();
  const Timestamp log_time(static_cast<std::int64_t>(reader.read<std::uint64_t>()));
  reader.read<std::uint64_t>();
  if (channel == channels_.end()) {
    ++unknown_messages_;
    return;
  }
  add_message(channel->second, log_time, region.source,
              {.chunk = region.compressed_chunk, .begin = begin + kMcapMessageHead, .size = size - kMcapMessageHead});
}

}  // namespace byre
