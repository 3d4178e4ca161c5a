#pragma once

#include "byre/io/ros/message_bytes.h"
#include "byre/trajectory.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace byre {

struct BagTopic {
  std::string name;
  std::string type;      // name in the bag: "sensor_msgs/msg/Image", or "sensor_msgs/Image" of ROS 1
  std::string encoding;  // "cdr", "ros1", or an unsupported one
  std::uint64_t messages = 0;
};

// Whether the topic's messages are of this type, in ROS 1 or in ROS 2.
bool has_type(const BagTopic& topic, std::string_view type);
template <ros::Message M>
bool holds(const BagTopic& topic) {
  return has_type(topic, M::kType);
}

// Empty for an unsupported encoding.
std::optional<ros::Encoding> encoding_of(const BagTopic& topic);

struct MessagePlace {
  std::uint32_t file = 0;                // number of the bag's file
  std::optional<std::uint64_t> chunk{};  // start of its compressed chunk in the file; empty if not in a chunk
  std::uint64_t begin = 0;               // first byte in the file or in the chunk, or the row in a database
  std::uint64_t size = 0;                // bytes; 0 in a database
};

// First bytes of a message: enough for the time stamp of its header.
using MessageHead = std::array<std::byte, 16>;

struct BagMessage {
  std::size_t topic = 0;  // number in BagContent::topics
  Timestamp log_time{};   // time of recording
  MessagePlace place{};
  MessageHead head{};  // zeros after the end of a shorter message
};

// Contents of a bag, collected in one pass. Lists only messages of the requested types.
struct BagContent {
  std::string storage;                   // "mcap", "sqlite3", "rosbag 2.0"
  std::vector<std::string> compression;  // all compressions in use: "zstd", "lz4", "bz2"
  std::uint64_t bytes = 0;               // size of its files
  std::vector<BagTopic> topics;          // in order of appearance
  std::vector<BagMessage> messages;      // ascending in log time
  std::uint64_t message_count = 0;       // messages of all types
  std::optional<Timestamp> first{};      // least and greatest log time of all messages
  std::optional<Timestamp> last{};
  std::vector<std::string> damage;  // unreadable parts and reasons; each names its file
};

// A bag of messages, which are read one at a time.
class Bag {
 public:
  virtual ~Bag() = default;
  const BagContent& content() const { return content_; }
  BagContent take_content() { return std::exchange(content_, {}); }  // leaves the content empty
  // The bytes of a message. Throws InputError if they cannot be read any more.
  virtual std::vector<std::byte> read(const BagMessage& message) = 0;

 protected:
  BagContent content_;
};

// Whether to list messages of a type; types have their ROS 2 names.
using TypeFilter = std::function<bool(std::string_view type)>;

// Whether a file or folder is a bag, by its first bytes or the names of its files.
bool is_bag(const std::filesystem::path& path);

// Files of an existing bag: the file itself, or metadata.yaml and the files in it, or the files next to it.
std::vector<std::filesystem::path> files_of_bag(const std::filesystem::path& path);

// Bound of the decompressed size of a file: far above that of camera images, far below that of decompression bombs.
struct BagLimits {
  std::uint64_t free_bytes = std::uint64_t{2} << 30;  // bytes allowed for a file of any size
  std::uint64_t ratio = 100;                          // further bytes allowed per byte of the file

  std::uint64_t most(std::uint64_t file_bytes) const { return free_bytes + ratio * file_bytes; }
};

// Scans the bag once and stores the locations of the requested messages: memory grows with their number, not with their
// size. Damaged or truncated bags are read as far as they are sound; BagContent::damage lists the rest. Formats:
//   a folder of rosbag2, with metadata.yaml or without   the files in it
//   .mcap                                                chunks none, lz4, zstd; with a summary or without
//   .db3                                                 sqlite3 of rosbag2
//   .mcap.zstd, .db3.zstd                                decompressed into a temporary file in TMPDIR
//   .bag                                                 ROS 1, version 2.0: chunks none, bz2, lz4; index optional
// Chunks beyond the limits count as damage; a .zstd file beyond them is refused. Throws InputError for other files, and
// for files that cannot be opened.
std::unique_ptr<Bag> open_bag(const std::filesystem::path& path, const TypeFilter& wanted,
                              const BagLimits& limits = {});

}  // namespace byre
