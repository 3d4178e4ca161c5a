#pragma once

#include "byre/bag/chunked_bag.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace byre {

// A bag of ROS 1, version 2.0 (http://wiki.ros.org/Bags/Format/2.0), read from its front to its back, so that it makes
// no difference whether it has an index.
class Ros1Bag final : public ChunkedBag {
 public:
  // Throws InputError when it does not begin as such bags do.
  Ros1Bag(std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted, const BagLimits& limits = {});

 private:
  // Where records follow each other: in the file or in a chunk.
  struct Region {
    ByteSource& source;
    std::uint64_t begin = 0, end = 0;
    bool is_chunk = false;
    std::optional<std::uint64_t> compressed_chunk{};  // where its record begins in the file
  };
  struct Record {
    std::map<std::string, std::vector<std::byte>, std::less<>> fields;
    std::uint64_t data_begin = 0;  // in its source
    std::uint64_t data_size = 0;   // bytes, as far as they are there
    bool is_whole = true;
  };

  CompressedPiece piece_at(std::uint64_t chunk) override;
  // The record that begins there; empty when it is cut before its data, or no record.
  std::optional<Record> record_at(const Region& region, std::uint64_t begin);
  // Takes all records of a region; gives where the first one begins that is cut or no record, else the end.
  std::uint64_t scan(const Region& region);
  void take_record(const Record& record, std::uint64_t begin, const Region& region);
  void take_file_header(const Record& record);
  void take_connection(const Record& record, const Region& region);
  void take_message(const Record& record, const Region& region);
  void take_chunk(const Record& record, std::uint64_t begin);

  std::unordered_map<std::uint32_t, std::size_t> connections_;  // numbers of topics
  bool is_indexed_ = false;
  std::uint64_t unknown_messages_ = 0;  // messages of connections that were not read
};

}  // namespace byre
