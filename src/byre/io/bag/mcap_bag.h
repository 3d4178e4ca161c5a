#pragma once

#include "byre/io/bag/chunked_bag.h"
#include "byre/io/bag/mcap_format.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>

namespace byre {

// An MCAP file, read sequentially, so that a summary is not required.
class McapBag final : public ChunkedBag {
 public:
  // Throws InputError if it does not begin with the magic number of MCAP.
  McapBag(std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted, const BagLimits& limits = {});

 private:
  struct Chunk {
    std::uint32_t checksum = 0;  // CRC-32 of the content, 0 if not recorded
    CompressedPiece piece{};
    bool is_supported = true;  // whether its compression is supported
  };

  CompressedPiece piece_at(std::uint64_t chunk) override;
  // Reads all records of a region; returns the position of the first one that is truncated or invalid, else the end.
  std::uint64_t scan(const Region& region);
  // All process the content of a record, which has this begin and size.
  void take_record(McapRecord kind, std::uint64_t begin, std::uint64_t size, const Region& region);
  Chunk chunk_of(std::uint64_t begin, std::uint64_t size);
  void take_chunk(std::uint64_t begin, std::uint64_t size);
  void take_schema(std::span<const std::byte> bytes, std::uint64_t begin);
  void take_channel(std::span<const std::byte> bytes, std::uint64_t begin);
  void take_message(std::uint64_t begin, std::uint64_t size, const Region& region);

  std::unordered_map<std::uint16_t, std::string> schemas_;   // names of types
  std::unordered_map<std::uint16_t, std::size_t> channels_;  // numbers of topics
  bool is_closed_ = false;                                   // whether the end of the data was read
  std::uint64_t unknown_messages_ = 0;                       // messages of channels without a readable definition
};

}  // namespace byre
