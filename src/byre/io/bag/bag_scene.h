#pragma once

#include "byre/base/byte_stream.h"
#include "byre/io/bag/bag.h"
#include "byre/io/bag/compression.h"
#include "byre/io/bag/mcap_format.h"
#include "byre/io/bag/mcap_writer.h"
#include "byre/io/ros/message_bytes.h"
#include "byre/io/ros/messages.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <unistd.h>

namespace byre {

using BagBytes = std::vector<std::byte>;

// Temporary folder for the bags of one test, removed after it.
class BagFolderTest : public testing::Test {
 protected:
  BagFolderTest() : folder_(std::filesystem::path(testing::TempDir()) / ("bag_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~BagFolderTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, std::span<const std::byte> bytes) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream file(folder_ / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return folder_ / name;
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    return write(name, std::as_bytes(std::span(text)));
  }

  std::filesystem::path folder_;
};

struct SceneMessage {
  std::string topic;
  std::string type;
  Timestamp log_time{};
  std::function<BagBytes(ros::Encoding)> bytes;
};

template <ros::Message M>
SceneMessage scene_message(const std::string& topic, Timestamp log_time, M message) {
  return {topic, std::string(M::kType), log_time,
          [message](ros::Encoding encoding) { return ros::write_message(message, encoding); }};
}

inline ros::Image scene_image(int number, Timestamp time) {
  ros::Image image{{ros::to_time(time), "camera", static_cast<std::uint32_t>(number)}, 4, 6, "mono8", 0, 6, {}};
  for (int i = 0; i < 24; ++i) image.data.push_back(static_cast<std::uint8_t>(10 * number + i));
  return image;
}

// Six image pairs, 50 ms apart, recorded 3 ms after their stamps, with text messages between them.
inline std::vector<SceneMessage> scene_messages() {
  std::vector<SceneMessage> messages;
  for (int i = 0; i < 6; ++i) {
    const Timestamp time = std::chrono::milliseconds(1000 + 50 * i);
    const Timestamp log_time = time + std::chrono::milliseconds(3);
    messages.push_back(scene_message("/left/image_raw", log_time, scene_image(i, time)));
    messages.push_back(scene_message("/right/image_raw", log_time, scene_image(100 + i, time)));
    messages.push_back(scene_message("/words", log_time, ros::String{"word " + std::to_string(i)}));
  }
  return messages;
}

template <typename Write>
void for_each_type(const std::vector<SceneMessage>& messages, Write write) {
  std::map<std::string, std::string> types;
  for (const SceneMessage& message : messages) types[message.topic] = message.type;
  for (const auto& [topic, type] : types) write(topic, type);
}

inline void write_record(ByteWriter& writer, McapRecord kind, const ByteWriter& content) {
  writer.write(kind);
  writer.write(std::uint64_t{content.size()});
  writer.write_bytes(content.bytes());
}

// Schemas, channels and messages of an MCAP file.
inline ByteWriter mcap_records(const std::vector<SceneMessage>& messages) {
  ByteWriter records;
  std::map<std::string, std::uint16_t> channels;
  for_each_type(messages, [&](const std::string& topic, const std::string& type) {
    const auto id = static_cast<std::uint16_t>(channels.size() + 1);
    channels[topic] = id;
    ByteWriter schema, channel;
    schema.write(id);
    for (const std::string& text : {type, std::string("ros2msg"), std::string()}) schema.write_text(text);
    write_record(records, McapRecord::schema, schema);
    channel.write(id);
    channel.write(id);
    channel.write_text(topic);
    channel.write_text("cdr");
    channel.write(std::uint32_t{0});
    write_record(records, McapRecord::channel, channel);
  });
  for (const SceneMessage& message : messages) {
    ByteWriter content;
    content.write(channels[message.topic]);
    content.write(std::uint32_t{0});
    content.write(message.log_time.count());
    content.write(message.log_time.count());
    content.write_bytes(message.bytes(ros::Encoding::cdr));
    write_record(records, McapRecord::message, content);
  }
  return records;
}

inline BagBytes lz4_frame(std::span<const std::byte> bytes) {
  BagBytes frame(LZ4F_compressFrameBound(bytes.size(), nullptr));
  frame.resize(LZ4F_compressFrame(frame.data(), frame.size(), bytes.data(), bytes.size(), nullptr));
  return frame;
}

// An MCAP file without summary: unchunked for the compression "-", else in one chunk of none (""), "lz4", "zstd".
inline BagBytes mcap_bytes(const std::vector<SceneMessage>& messages, const std::string& compression) {
  const ByteWriter records = mcap_records(messages);
  ByteWriter file, header, end;
  file.write_bytes(kMcapMagic);
  header.write_text("ros2");
  header.write_text("test");
  write_record(file, McapRecord::header, header);
  if (compression == "-") {
    file.write_bytes(records.bytes());
  } else {
    BagBytes packed = records.bytes();
    if (compression == "lz4") packed = lz4_frame(records.bytes());
    if (compression == "zstd") packed = compress_zstd(records.bytes());
    ByteWriter chunk;
    chunk.write(std::uint64_t{0});
    chunk.write(std::uint64_t{0});
    chunk.write(std::uint64_t{records.size()});
    chunk.write(std::uint32_t{0});
    chunk.write_text(compression);
    chunk.write(std::uint64_t{packed.size()});
    chunk.write_bytes(packed);
    write_record(file, McapRecord::chunk, chunk);
  }
  end.write(std::uint32_t{0});
  write_record(file, McapRecord::data_end, end);
  file.write_bytes(kMcapMagic);
  return file.bytes();
}

using RosFields = std::vector<std::pair<std::string, BagBytes>>;

template <typename T>
BagBytes field_bytes(T value) {
  ByteWriter writer;
  writer.write(value);
  return writer.bytes();
}

inline BagBytes field_bytes(const std::string& text) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

inline BagBytes ros1_fields(const RosFields& fields) {
  ByteWriter writer;
  for (const auto& [name, value] : fields) {
    writer.write(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    writer.write_bytes(field_bytes(name + "="));
    writer.write_bytes(value);
  }
  return writer.bytes();
}

inline void write_ros1_record(ByteWriter& writer, const RosFields& fields, std::span<const std::byte> data) {
  const BagBytes header = ros1_fields(fields);
  writer.write(static_cast<std::uint32_t>(header.size()));
  writer.write_bytes(header);
  writer.write(static_cast<std::uint32_t>(data.size()));
  writer.write_bytes(data);
}

inline std::uint64_t ros1_time(Timestamp time) {
  const ros::Time parts = ros::to_time(time);
  return static_cast<std::uint64_t>(parts.nanosec) << 32 | static_cast<std::uint32_t>(parts.sec);
}

// A bag of ROS 1 that its recorder did not close: chunks of none or lz4, no index.
inline BagBytes ros1_bytes(const std::vector<SceneMessage>& messages, const std::string& compression = "none") {
  ByteWriter records;
  std::map<std::string, std::uint32_t> connections;
  for_each_type(messages, [&](const std::string& topic, const std::string& type) {
    const auto id = static_cast<std::uint32_t>(connections.size());
    connections[topic] = id;
    write_ros1_record(records,
                      {{"op", field_bytes(std::uint8_t{7})}, {"conn", field_bytes(id)}, {"topic", field_bytes(topic)}},
                      ros1_fields({{"topic", field_bytes(topic)}, {"type", field_bytes(ros::short_type(type))}}));
  });
  for (const SceneMessage& message : messages) {
    write_ros1_record(records,
                      {{"op", field_bytes(std::uint8_t{2})},
                       {"conn", field_bytes(connections[message.topic])},
                       {"time", field_bytes(ros1_time(message.log_time))}},
                      message.bytes(ros::Encoding::ros1));
  }
  ByteWriter file;
  file.write_bytes(field_bytes(std::string("#ROSBAG V2.0\n")));
  write_ros1_record(file, {{"op", field_bytes(std::uint8_t{3})}, {"index_pos", field_bytes(std::uint64_t{0})}},
                    BagBytes(64, std::byte{' '}));
  write_ros1_record(file,
                    {{"op", field_bytes(std::uint8_t{5})},
                     {"compression", field_bytes(compression)},
                     {"size", field_bytes(static_cast<std::uint32_t>(records.size()))}},
                    compression == "lz4" ? lz4_frame(records.bytes()) : records.bytes());
  return file.bytes();
}

// A database in the format of rosbag2 in Humble; pack changes the bytes of each message before they are stored.
inline void write_db3(const std::filesystem::path& path, const std::vector<SceneMessage>& messages,
                      const std::function<BagBytes(const BagBytes&)>& pack = {}) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const char* const tables =
      "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
      "data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN";
  ASSERT_EQ(sqlite3_exec(database, tables, nullptr, nullptr, nullptr), SQLITE_OK);
  std::map<std::string, int> ids;
  for_each_type(messages, [&](const std::string& topic, const std::string& type) {
    ids[topic] = static_cast<int>(ids.size()) + 1;
    const std::string insert =
        "INSERT INTO topics VALUES(" + std::to_string(ids[topic]) + ", '" + topic + "', '" + type + "', 'cdr', '')";
    ASSERT_EQ(sqlite3_exec(database, insert.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  });
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1, &insert, nullptr);
  for (const SceneMessage& message : messages) {
    const BagBytes bytes = message.bytes(ros::Encoding::cdr);
    const BagBytes stored = pack ? pack(bytes) : bytes;
    sqlite3_bind_int(insert, 1, ids[message.topic]);
    sqlite3_bind_int64(insert, 2, message.log_time.count());
    sqlite3_bind_blob(insert, 3, stored.data(), static_cast<int>(stored.size()), SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  ASSERT_EQ(sqlite3_exec(database, "COMMIT", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
}

inline bool every_type(std::string_view /*type*/) {
  return true;
}

// Each readable message, as "topic log_time size".
inline std::vector<std::string> readable_messages(Bag& bag) {
  std::vector<std::string> found;
  for (const BagMessage& message : bag.content().messages) {
    found.push_back(bag.content().topics[message.topic].name + " " + std::to_string(message.log_time.count()) + " " +
                    std::to_string(bag.read(message).size()));
  }
  return found;
}

}  // namespace byre
