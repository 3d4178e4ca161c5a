#pragma once

#include "byre/bag/chunked_bag.h"
#include "byre/bag/mcap_format.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>

namespace byre {

// An MCAP file, read from its front to its back, so that it makes no difference whether it has a summary.
class McapBag final : public ChunkedBag {
 public:
  // Throws InputError when it does not begin as MCAP files do.
  McapBag(std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted, const BagLimits& limits = {});

 private:
  // What is read of a chunk before its records.
  struct Chunk {
    std::uint32_t checksum = 0;  // CRC-32 of what it holds, 0 where none was taken
    CompressedPiece piece{};
    bool is_known = true;  // its compression is
  };

  // Where records follow each other: in the file or in a chunk.
  struct Region {
    ByteSource& source;
    std::uint64_t begin = 0, end = 0;
    bool is_chunk = false;
    std::optional<std::uint64_t> compressed_chunk{};  // where its record begins in the file
  };

  CompressedPiece piece_at(std::uint64_t chunk) override;
  // Takes all records of a region; gives where the first one begins that is cut or no record, else the end.
  std::uint64_t scan(const Region& region);
  // All take the content of a record, which begins there and is so long.
  void take_record(McapRecord kind, std::uint64_t begin, std::uint64_t size, const Region& region);
  Chunk chunk_of(std::uint64_t begin, std::uint64_t size);
  void take_chunk(std::uint64_t begin, std::uint64_t size);
  void take_schema(std::span<const std::byte> bytes, std::uint64_t begin);
  void take_channel(std::span<const std::byte> bytes, std::uint64_t begin);
  void take_message(std::uint64_t begin, std::uint64_t size, const Region& region);

  std::unordered_map<std::uint16_t, std::string> schemas_;   // names of types
  std::unordered_map<std::uint16_t, std::size_t> channels_;  // numbers of topics
  bool is_closed_ = false;                                   // the end of the data was read
  std::uint64_t unknown_messages_ = 0;                       // messages of channels that were not read
};

}  // namespace byre
