#include "byre/io/bag/mcap_writer.h"

#include "byre/io/bag/compression.h"
#include "byre/io/bag/mcap_format.h"

#include <algorithm>
#include <functional>

#include <zlib.h>

namespace byre {
namespace {

constexpr std::size_t kChunkBytes = 1u << 20;

void write_record(ByteWriter& writer, McapRecord kind, const ByteWriter& content) {
  writer.write(kind);
  writer.write(std::uint64_t{content.size()});
  writer.write_bytes(content.bytes());
}

// Arrays and maps: their length in bytes, then their entries.
void write_entries(ByteWriter& writer, const ByteWriter& entries) {
  writer.write(static_cast<std::uint32_t>(entries.size()));
  writer.write_bytes(entries.bytes());
}

// Quality-of-service settings that a ROS 2 recorder would have stored, in the format of rosbag2 up to version 8.
std::string qos_of(ros::Durability durability) {
  const std::string forever = "\n    sec: 9223372036\n    nsec: 854775807\n";
  return "- history: 1\n  depth: 10\n  reliability: 1\n  durability: " +
         std::string(durability == ros::Durability::latched ? "1" : "2") + "\n  deadline:" + forever +
         "  lifespan:" + forever + "  liveliness: 1\n  liveliness_lease_duration:" + forever +
         "  avoid_ros_namespace_conventions: false";
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path)
    : file_(std::make_unique<OutputFile>(path, FileContent::mcap)) {
  ByteWriter header, start;
  header.write_text("ros2");
  header.write_text("byre " BYRE_VERSION);
  start.write_bytes(kMcapMagic);
  write_record(start, McapRecord::header, header);
  append(start);
  file_->publish();
}

void McapWriter::append(const ByteWriter& writer) {
  file_->append(writer.bytes());
  position_ += writer.size();
}

McapWriter::TopicId McapWriter::add(ros::Topic topic) {
  const auto known = std::ranges::find(schemas_, topic.type, &Schema::type);
  const auto id = static_cast<std::uint16_t>(known - schemas_.begin() + 1);
  if (known == schemas_.end()) {
    schemas_.push_back({std::move(topic.type), std::move(topic.schema)});
    write_schema(chunk_, id, schemas_.back());
  }
  const auto channel = static_cast<TopicId>(channels_.size());
  channels_.push_back({std::move(topic.name), id, topic.durability});
  write_channel(chunk_, channel, channels_.back());
  return channel;
}

void McapWriter::write_schema(ByteWriter& writer, std::uint16_t id, const Schema& schema) {
  ByteWriter content;
  content.write(id);
  content.write_text(schema.type);
  content.write_text("ros2msg");
  content.write_text(schema.text);
  write_record(writer, McapRecord::schema, content);
}

void McapWriter::write_channel(ByteWriter& writer, std::uint16_t id, const Channel& channel) {
  ByteWriter content, metadata;
  metadata.write_text("offered_qos_profiles");
  metadata.write_text(qos_of(channel.durability));
  content.write(id);
  content.write(channel.schema);
  content.write_text(channel.topic);
  content.write_text("cdr");
  write_entries(content, metadata);
  write_record(writer, McapRecord::channel, content);
}

void McapWriter::put(TopicId topic, Timestamp time, std::vector<std::byte> cdr) {
  const auto log_time = static_cast<std::uint64_t>(time.count());
  Channel& channel = channels_[topic];
  if (chunk_messages_.empty()) chunk_start_ = chunk_end_ = log_time;
  chunk_start_ = std::min(chunk_start_, log_time);
  chunk_end_ = std::max(chunk_end_, log_time);
  chunk_messages_[topic].emplace_back(log_time, chunk_.size());
  ByteWriter content;
  content.write(topic);
  content.write(static_cast<std::uint32_t>(channel.messages++));
  content.write(log_time);
  content.write(log_time);
  content.write_bytes(cdr);
  write_record(chunk_, McapRecord::message, content);
  if (chunk_.size() >= kChunkBytes) flush();
}

void McapWriter::flush() {
  if (chunk_messages_.empty()) return;
  const std::vector<std::byte> compressed = compress_zstd(chunk_.bytes());
  ChunkIndex chunk{.start = chunk_start_, .end = chunk_end_, .begin = position_};
  chunk.compressed_size = compressed.size();
  chunk.size = chunk_.size();
  ByteWriter content, record;
  content.write(chunk.start);
  content.write(chunk.end);
  content.write(chunk.size);
  content.write(mcap_checksum(chunk_.bytes()));
  content.write_text("zstd");
  content.write(chunk.compressed_size);
  content.write_bytes(compressed);
  write_record(record, McapRecord::chunk, content);
  chunk.length = record.size();
  append(record);
  write_message_indexes(chunk);
  chunks_.push_back(std::move(chunk));
  chunk_ = {};
  chunk_messages_.clear();
}

void McapWriter::write_message_indexes(ChunkIndex& chunk) {
  const std::uint64_t begin = position_;
  for (auto& [topic, messages] : chunk_messages_) {
    std::ranges::stable_sort(messages, {}, [](const auto& message) { return message.first; });
    ByteWriter content, entries, record;
    for (const auto& [time, place] : messages) {
      entries.write(time);
      entries.write(place);
    }
    content.write(topic);
    write_entries(content, entries);
    write_record(record, McapRecord::message_index, content);
    chunk.message_indexes[topic] = position_;
    append(record);
  }
  chunk.message_index_length = position_ - begin;
}

void McapWriter::write_chunk_index(ByteWriter& writer, const ChunkIndex& chunk) {
  ByteWriter content, entries;
  for (const auto& [topic, place] : chunk.message_indexes) {
    entries.write(topic);
    entries.write(place);
  }
  content.write(chunk.start);
  content.write(chunk.end);
  content.write(chunk.begin);
  content.write(chunk.length);
  write_entries(content, entries);
  content.write(chunk.message_index_length);
  content.write_text("zstd");
  content.write(chunk.compressed_size);
  content.write(chunk.size);
  write_record(writer, McapRecord::chunk_index, content);
}

void McapWriter::write_statistics(ByteWriter& writer) const {
  ByteWriter content, counts;
  std::uint64_t messages = 0, start = 0, end = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    messages += channels_[i].messages;
    counts.write(static_cast<std::uint16_t>(i));
    counts.write(channels_[i].messages);
  }
  if (!chunks_.empty()) {
    start = std::ranges::min(chunks_, {}, &ChunkIndex::start).start;
    end = std::ranges::max(chunks_, {}, &ChunkIndex::end).end;
  }
  content.write(messages);
  content.write(static_cast<std::uint16_t>(schemas_.size()));
  content.write(static_cast<std::uint32_t>(channels_.size()));
  content.write(std::uint32_t{0});  // attachments
  content.write(std::uint32_t{0});  // metadata
  content.write(static_cast<std::uint32_t>(chunks_.size()));
  content.write(start);
  content.write(end);
  write_entries(content, counts);
  write_record(writer, McapRecord::statistics, content);
}

void McapWriter::close() {
  flush();
  ByteWriter data_end, end;
  data_end.write(std::uint32_t{0});  // no checksum of all data
  write_record(end, McapRecord::data_end, data_end);
  append(end);

  const std::uint64_t summary_begin = position_;
  ByteWriter summary, offsets;
  const auto add_group = [&](McapRecord kind, const std::function<void()>& write_group) {
    const std::uint64_t begin = summary.size();
    write_group();
    if (summary.size() == begin) return;
    ByteWriter content;
    content.write(kind);
    content.write(summary_begin + begin);
    content.write(summary.size() - begin);
    write_record(offsets, McapRecord::summary_offset, content);
  };
  add_group(McapRecord::schema, [&] {
    for (std::size_t i = 0; i < schemas_.size(); ++i) {
      write_schema(summary, static_cast<std::uint16_t>(i + 1), schemas_[i]);
    }
  });
  add_group(McapRecord::channel, [&] {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      write_channel(summary, static_cast<std::uint16_t>(i), channels_[i]);
    }
  });
  add_group(McapRecord::statistics, [&] { write_statistics(summary); });
  add_group(McapRecord::chunk_index, [&] {
    for (const ChunkIndex& chunk : chunks_) write_chunk_index(summary, chunk);
  });
  const std::uint64_t offsets_begin = summary_begin + summary.size();
  summary.write_bytes(offsets.bytes());

  // The checksum includes the first fields of the footer.
  summary.write(McapRecord::footer);
  summary.write(std::uint64_t{kMcapFooter});
  summary.write(summary_begin);
  summary.write(offsets_begin);
  summary.write(mcap_checksum(summary.bytes()));
  summary.write_bytes(kMcapMagic);
  append(summary);
  file_->sync();
}

}  // namespace byre
