#pragma once

#include "byre/bag/bag.h"
#include "byre/bag/byte_source.h"
#include "byre/bag/compression.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace byre {

// A compressed piece of a file.
struct CompressedPiece {
  Compression compression = Compression::none;
  std::uint64_t begin = 0;          // first byte in the file
  std::uint64_t size = 0;           // bytes in the file, as far as they are there
  std::uint64_t original_size = 0;  // bytes when decompressed, as the file says
};

// A bag in one file whose messages lie in it as they are or in compressed chunks. The formats say where.
class ChunkedBag : public Bag {
 public:
  const BagContent& content() const final { return content_; }
  BagContent take_content() final { return std::exchange(content_, {}); }
  std::vector<std::byte> read(const BagMessage& message) final;

 protected:
  // storage: what the format is called; place: how errors name the file.
  ChunkedBag(std::string storage, std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted,
             const BagLimits& limits);

  // The compressed piece of the chunk whose record begins there. Throws InputError when there is none any more.
  virtual CompressedPiece piece_at(std::uint64_t chunk) = 0;

  ByteSource& file() { return *source_; }
  const std::string& place() const { return place_; }

  // A decompressed chunk for the scan; empty once all chunks together exceed the bound of the file.
  std::optional<Decompressed> scan_piece(const CompressedPiece& piece);

  std::size_t topic_number(const std::string& name, const std::string& type, const std::string& encoding);
  // Bytes that lie in source, which is the file or a chunk of it.
  void add_message(std::size_t topic, Timestamp log_time, ByteSource& source, const MessagePlace& place);
  void add_compression(Compression compression);
  void add_damage(const std::string& what) { content_.damage.push_back(place_ + ": " + what); }
  // Counts chunks and other records that are damaged, of which the first is told.
  void add_broken(std::uint64_t record, const std::string& why);
  void finish_scan();  // to be called when all was added

 private:
  struct CachedChunk {
    std::uint64_t begin = 0;
    std::vector<std::byte> bytes{};
  };
  std::span<const std::byte> chunk_at(std::uint64_t begin);
  // Chunks that claim more than kMostChunkBytes are damaged.
  Decompressed decompress_piece(const CompressedPiece& piece);

  std::unique_ptr<ByteSource> source_;
  std::string place_;  // constant after construction
  TypeFilter wanted_;  // constant after construction
  BagContent content_;
  std::vector<bool> is_wanted_;  // by topic
  std::unordered_map<std::string, std::size_t> topic_numbers_;
  std::uint64_t most_decompressed_;  // bound of all chunks, bytes; constant after construction
  std::uint64_t decompressed_ = 0;   // stated bytes of the chunks scanned so far
  std::uint64_t left_out_ = 0;       // number of chunks beyond most_decompressed_
  std::uint64_t broken_ = 0;
  std::string first_broken_;
  std::array<std::optional<CachedChunk>, 2> cache_;  // the last one first: left and right images may lie in two
};

// "is cut or damaged from byte 120 of 400 on; what comes before was read"
std::string cut_at(std::uint64_t begin, std::uint64_t size);

// How many bytes a chunk may have when decompressed; more is taken for damage.
inline constexpr std::uint64_t kMostChunkBytes = 256u << 20;

}  // namespace byre
