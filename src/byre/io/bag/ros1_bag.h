#pragma once

#include "byre/io/bag/chunked_bag.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace byre {

// A bag of ROS 1, version 2.0 (http://wiki.ros.org/Bags/Format/2.0), read sequentially, so that an index is not
// required.
class Ros1Bag final : public ChunkedBag {
 public:
  // Throws InputError if it does not begin with the magic number of such bags.
  Ros1Bag(std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted, const BagLimits& limits = {});

 private:
  struct Record {
    std::map<std::string, std::vector<std::byte>, std::less<>> fields;
    std::uint64_t data_begin = 0;  // position in its source
    std::uint64_t data_size = 0;   // bytes, fewer if truncated
    bool is_whole = true;
  };

  CompressedPiece piece_at(std::uint64_t chunk) override;
  // The record at this position; empty if it is truncated before its data, or invalid.
  std::optional<Record> record_at(const Region& region, std::uint64_t begin);
  // Reads all records of a region; returns the position of the first one that is truncated or invalid, else the end.
  std::uint64_t scan(const Region& region);
  void take_record(const Record& record, std::uint64_t begin, const Region& region);
  void take_file_header(const Record& record);
  void take_connection(const Record& record, const Region& region);
  void take_message(const Record& record, const Region& region);
  void take_chunk(const Record& record, std::uint64_t begin);

  std::unordered_map<std::uint32_t, std::size_t> connections_;  // numbers of topics
  bool is_indexed_ = false;
  std::uint64_t unknown_messages_ = 0;  // messages of connections without a readable definition
};

}  // namespace byre
