#pragma once

#include "byre/base/byte_stream.h"
#include "byre/base/output_file.h"
#include "byre/io/ros/message_sink.h"
#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// Writes an MCAP file of ROS 2 messages (profile ros2): chunks compressed with zstd, indexed. After a crash of the
// program or the machine, messages up to the last flush are readable. All throw InputError if the file cannot be
// written.
class McapWriter : public ros::MessageSink {
 public:
  explicit McapWriter(const std::filesystem::path& path);

  TopicId add(ros::Topic topic) override;
  bool is_wanted(TopicId /*topic*/) const override { return true; }
  void put(TopicId topic, Timestamp time, std::vector<std::byte> cdr) override;

  void flush();  // ends the chunk and writes it
  void close();  // writes the summary; call it once, last

 private:
  struct Channel {
    std::string topic;
    std::uint16_t schema = 0;
    ros::Durability durability{};
    std::uint64_t messages = 0;
  };
  struct Schema {
    std::string type;
    std::string text;
  };
  struct ChunkIndex {
    std::uint64_t start = 0, end = 0;     // log times
    std::uint64_t begin = 0, length = 0;  // position of its record
    std::map<std::uint16_t, std::uint64_t> message_indexes{};
    std::uint64_t message_index_length = 0;
    std::uint64_t compressed_size = 0, size = 0;
  };

  static void write_schema(ByteWriter& writer, std::uint16_t id, const Schema& schema);
  static void write_channel(ByteWriter& writer, std::uint16_t id, const Channel& channel);
  static void write_chunk_index(ByteWriter& writer, const ChunkIndex& chunk);
  void write_statistics(ByteWriter& writer) const;
  void write_message_indexes(ChunkIndex& chunk);
  void append(const ByteWriter& writer);

  std::unique_ptr<OutputFile> file_;
  std::uint64_t position_ = 0;     // bytes written to the file
  std::vector<Schema> schemas_;    // indexed by id - 1
  std::vector<Channel> channels_;  // indexed by id
  std::vector<ChunkIndex> chunks_;
  ByteWriter chunk_;  // records of the current chunk
  std::uint64_t chunk_start_ = 0, chunk_end_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages_;  // time, position
};

}  // namespace byre
