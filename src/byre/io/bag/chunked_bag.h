#pragma once

#include "byre/io/bag/bag.h"
#include "byre/io/bag/compression.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace byre {

struct CompressedPiece {
  Compression compression = Compression::none;
  std::uint64_t begin = 0;          // first byte in the file
  std::uint64_t size = 0;           // bytes in the file, fewer if truncated
  std::uint64_t original_size = 0;  // stated size after decompression, bytes
};

// A bag in one file, with messages directly in it or in compressed chunks. Derived classes implement the formats.
class ChunkedBag : public Bag {
 public:
  std::vector<std::byte> read(const BagMessage& message) final;

 protected:
  // A sequence of records: the file or a chunk.
  struct Region {
    ByteSource& source;
    std::uint64_t begin = 0, end = 0;
    bool is_chunk = false;
    std::optional<std::uint64_t> compressed_chunk{};  // position of its record in the file
  };

  // storage: name of the format; place: name of the file in errors.
  ChunkedBag(std::string storage, std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted,
             const BagLimits& limits);

  // The compressed piece of the chunk with its record at this position. Throws InputError if there is none any more.
  virtual CompressedPiece piece_at(std::uint64_t chunk) = 0;

  ByteSource& file() { return *source_; }
  const std::string& place() const { return place_; }

  // A decompressed chunk for the scan; empty once all chunks together exceed the bound of the file.
  std::optional<Decompressed> scan_piece(const CompressedPiece& piece);

  std::size_t topic_number(const std::string& name, const std::string& type, const std::string& encoding);
  // source: the file or a chunk of it.
  void add_message(std::size_t topic, Timestamp log_time, ByteSource& source, const MessagePlace& place);
  void add_compression(Compression compression);
  void add_damage(const std::string& what) { content_.damage.push_back(place_ + ": " + what); }
  // Counts damaged chunks and other records; the first one is reported.
  void add_broken(std::uint64_t record, const std::string& why);
  void finish_scan();  // call it after the last addition

 private:
  struct CachedChunk {
    std::uint64_t begin = 0;
    std::vector<std::byte> bytes{};
  };
  std::span<const std::byte> chunk_at(std::uint64_t begin);
  // Chunks that claim more than kMaxChunkBytes are damaged.
  Decompressed decompress_piece(const CompressedPiece& piece);

  std::unique_ptr<ByteSource> source_;
  std::string place_;            // constant after construction
  TypeFilter wanted_;            // constant after construction
  std::vector<bool> is_wanted_;  // indexed by topic
  std::unordered_map<std::string, std::size_t> topic_numbers_;
  std::uint64_t max_decompressed_;  // bound of all chunks, bytes; constant after construction
  std::uint64_t decompressed_ = 0;  // stated bytes of the chunks scanned so far
  std::uint64_t skipped_ = 0;       // number of chunks beyond max_decompressed_
  std::uint64_t broken_ = 0;
  std::string first_broken_;
  // Last one first. Two, because left and right images may be in different chunks.
  std::array<std::optional<CachedChunk>, 2> cache_;
};

// Text such as "is cut or damaged from byte 120 of 400 on; what comes before was read".
std::string truncation_text(std::uint64_t begin, std::uint64_t size);

// Largest size of a decompressed chunk, bytes; a larger one counts as damage.
inline constexpr std::uint64_t kMaxChunkBytes = 256u << 20;

}  // namespace byre
