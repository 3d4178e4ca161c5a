#include "byre/io/bag/ros1_bag.h"

#include "byre/base/byte_stream.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace byre {
namespace {

using Fields = std::map<std::string, std::vector<std::byte>, std::less<>>;

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::uint64_t kMaxHeader = 1u << 20;            // bytes of a record's header
constexpr std::uint64_t kMaxConnectionBytes = 16u << 20;  // bytes of the description of a connection

enum class Operation : std::uint8_t {
  message = 2,
  file_header = 3,
  index = 4,
  chunk = 5,
  chunk_info = 6,
  connection = 7
};

// Fields of a header, each consisting of length, name, "=" and value.
Fields fields_of(std::span<const std::byte> bytes, const std::string& place, std::uint64_t begin) {
  Fields fields;
  ByteReader reader(bytes, place, begin);
  while (reader.remaining() > 0) {
    const std::string field = reader.read_text();
    const std::size_t equals = field.find('=');
    if (equals == std::string::npos) reader.fail("a header field has no \"=\"");
    const std::span<const std::byte> value = std::as_bytes(std::span(field)).subspan(equals + 1);
    fields[field.substr(0, equals)] = {value.begin(), value.end()};
  }
  return fields;
}

template <typename T>
std::optional<T> number(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, found->second.data(), sizeof(T));
  return value;
}

std::string text(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end()) return {};
  return {reinterpret_cast<const char*>(found->second.data()), found->second.size()};
}

Timestamp time_of(const Fields& fields) {
  const auto both = number<std::uint64_t>(fields, "time").value_or(0);
  return std::chrono::seconds(both & 0xFFFFFFFFu) + std::chrono::nanoseconds(both >> 32);
}

}  // namespace

Ros1Bag::Ros1Bag(std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted, const BagLimits& limits)
    : ChunkedBag("rosbag 2.0", std::move(source), std::move(place), std::move(wanted), limits) {
  const std::vector<std::byte> magic = read_piece(file(), 0, kMagic.size());
  if (!std::ranges::equal(magic, std::as_bytes(std::span(kMagic)))) {
    throw InputError(this->place(), "does not begin with the magic of ROS 1 bags, version 2.0",
                     "use a copy, or convert older versions with \"rosbag fix\"");
  }
  const std::uint64_t end = file().size();
  const std::uint64_t stop = scan({file(), kMagic.size(), end});
  if (unknown_messages_ > 0) {
    add_damage(std::to_string(unknown_messages_) + " messages belong to undeclared connections");
  }
  if (stop < end) add_damage(truncation_text(stop, end));
  if (stop == end && !is_indexed_) add_damage("was not closed: it has no index");
  finish_scan();
}

std::optional<Ros1Bag::Record> Ros1Bag::record_at(const Region& region, std::uint64_t begin) {
  constexpr std::uint64_t kLength = sizeof(std::uint32_t);
  const auto length_at = [&](std::uint64_t at) -> std::optional<std::uint32_t> {
    if (at > region.end || region.end - at < kLength) return std::nullopt;
    const std::vector<std::byte> bytes = read_piece(region.source, at, kLength);
    return ByteReader(bytes, place(), at).read<std::uint32_t>();
  };
  const std::optional<std::uint32_t> header_size = length_at(begin);
  if (!header_size || *header_size > kMaxHeader || *header_size > region.end - begin - kLength) return std::nullopt;
  const std::uint64_t header = begin + kLength;
  const std::optional<std::uint32_t> data_size = length_at(header + *header_size);
  if (!data_size) return std::nullopt;
  Record record;
  record.fields = fields_of(read_piece(region.source, header, *header_size), place(), header);
  record.data_begin = header + *header_size + kLength;
  record.data_size = std::min<std::uint64_t>(*data_size, region.end - record.data_begin);
  record.is_whole = record.data_size == *data_size;
  return record;
}

std::uint64_t Ros1Bag::scan(const Region& region) {
  std::uint64_t begin = region.begin;
  while (begin < region.end) {
    std::optional<Record> record;
    try {
      record = record_at(region, begin);
      if (record) take_record(*record, begin, region);
    } catch (const InputError& error) {
      add_broken(begin, "cannot be read: " + error.reason());
    }
    if (!record || !record->is_whole) break;
    begin = record->data_begin + record->data_size;
  }
  return begin;
}

void Ros1Bag::take_record(const Record& record, std::uint64_t begin, const Region& region) {
  const auto operation = number<Operation>(record.fields, "op");
  if (operation == Operation::chunk && !region.is_chunk) return take_chunk(record, begin);
  if (!record.is_whole) return;
  if (operation == Operation::message) return take_message(record, region);
  if (operation == Operation::connection) return take_connection(record, region);
  if (operation == Operation::file_header) take_file_header(record);
}

void Ros1Bag::take_file_header(const Record& record) {
  is_indexed_ = number<std::uint64_t>(record.fields, "index_pos").value_or(0) != 0;
}

void Ros1Bag::take_connection(const Record& record, const Region& region) {
  const auto connection = number<std::uint32_t>(record.fields, "conn");
  if (!connection || record.data_size > kMaxConnectionBytes) return;
  const std::vector<std::byte> data = read_piece(region.source, record.data_begin, record.data_size);
  const std::string type = text(fields_of(data, place(), record.data_begin), "type");
  connections_[*connection] = topic_number(text(record.fields, "topic"), type, "ros1");
}

void Ros1Bag::take_message(const Record& record, const Region& region) {
  const auto connection = number<std::uint32_t>(record.fields, "conn");
  const auto topic = connection ? connections_.find(*connection) : connections_.end();
  if (topic == connections_.end()) {
    ++unknown_messages_;
    return;
  }
  add_message(topic->second, time_of(record.fields), region.source,
              {.chunk = region.compressed_chunk, .begin = record.data_begin, .size = record.data_size});
}

void Ros1Bag::take_chunk(const Record& record, std::uint64_t begin) {
  const std::optional<Compression> compression = parse_compression(text(record.fields, "compression"));
  if (!compression) return add_broken(begin, "has an unsupported compression");
  add_compression(*compression);
  if (*compression == Compression::none) {
    const std::uint64_t end = record.data_begin + record.data_size;
    if (scan({file(), record.data_begin, end, true}) < end) add_broken(begin, "ends in the middle of a message");
    return;
  }
  const std::optional<Decompressed> chunk = scan_piece(
      {*compression, record.data_begin, record.data_size, number<std::uint32_t>(record.fields, "size").value_or(0)});
  if (!chunk) return;
  MemorySource source(chunk->bytes);
  const bool is_complete = scan({source, 0, source.size(), true, begin}) == source.size();
  if (!chunk->is_whole || !is_complete) add_broken(begin, "cannot be decompressed completely");
}

CompressedPiece Ros1Bag::piece_at(std::uint64_t chunk) {
  const std::optional<Record> record = record_at({file(), 0, file().size()}, chunk);
  if (!record) throw InputError(place(), "has changed while being read", "check that no program writes to the file");
  return {parse_compression(text(record->fields, "compression")).value_or(Compression::none), record->data_begin,
          record->data_size, number<std::uint32_t>(record->fields, "size").value_or(0)};
}

}  // namespace byre
