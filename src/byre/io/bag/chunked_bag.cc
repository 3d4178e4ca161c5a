#include "byre/io/bag/chunked_bag.h"

#include "byre/input_error.h"

#include <algorithm>

namespace byre {

ChunkedBag::ChunkedBag(std::string storage, std::unique_ptr<ByteSource> source, std::string place, TypeFilter wanted,
                       const BagLimits& limits)
    : source_(std::move(source)),
      place_(std::move(place)),
      wanted_(std::move(wanted)),
      max_decompressed_(limits.most(source_->size())) {
  content_.storage = std::move(storage);
  content_.bytes = source_->size();
}

Decompressed ChunkedBag::decompress_piece(const CompressedPiece& piece) {
  if (piece.original_size > kMaxChunkBytes) return {};
  return decompress(piece.compression, read_piece(*source_, piece.begin, piece.size), piece.original_size);
}

std::optional<Decompressed> ChunkedBag::scan_piece(const CompressedPiece& piece) {
  const std::uint64_t stated = std::min(piece.original_size, kMaxChunkBytes);
  if (skipped_ > 0 || stated > max_decompressed_ - decompressed_) {
    ++skipped_;
    return std::nullopt;
  }
  decompressed_ += stated;
  return decompress_piece(piece);
}

std::span<const std::byte> ChunkedBag::chunk_at(std::uint64_t begin) {
  const auto is_it = [begin](const std::optional<CachedChunk>& each) { return each && each->begin == begin; };
  const auto cached = std::ranges::find_if(cache_, is_it);
  if (cached == cache_.end()) {
    cache_.back() = CachedChunk{begin, decompress_piece(piece_at(begin)).bytes};
    std::rotate(cache_.begin(), std::prev(cache_.end()), cache_.end());
  } else {
    std::rotate(cache_.begin(), cached, std::next(cached));
  }
  return cache_.front()->bytes;
}

std::vector<std::byte> ChunkedBag::read(const BagMessage& message) {
  const MessagePlace& place = message.place;
  std::vector<std::byte> bytes;
  if (!place.chunk) {
    bytes = read_piece(*source_, place.begin, place.size);
  } else if (const std::span<const std::byte> chunk = chunk_at(*place.chunk);
             place.begin + place.size <= chunk.size()) {
    const std::span<const std::byte> found = chunk.subspan(place.begin, place.size);
    bytes.assign(found.begin(), found.end());
  }
  if (bytes.size() == place.size) return bytes;
  throw InputError(place_, "a message can no longer be read", "check the disk, and that no program writes to the file");
}

std::size_t ChunkedBag::topic_number(const std::string& name, const std::string& type, const std::string& encoding) {
  std::string key = name;
  key.append(1, '\0').append(type).append(1, '\0').append(encoding);
  const auto [found, is_new] = topic_numbers_.try_emplace(std::move(key), content_.topics.size());
  if (is_new) {
    content_.topics.push_back({name, type, encoding});
    is_wanted_.push_back(wanted_(type));
  }
  return found->second;
}

void ChunkedBag::add_message(std::size_t topic, Timestamp log_time, ByteSource& source, const MessagePlace& place) {
  ++content_.message_count;
  ++content_.topics[topic].messages;
  content_.first = std::min(content_.first.value_or(log_time), log_time);
  content_.last = std::max(content_.last.value_or(log_time), log_time);
  if (!is_wanted_[topic]) return;
  BagMessage message{topic, log_time, place};
  source.read(place.begin, std::span(message.head).first(std::min<std::uint64_t>(message.head.size(), place.size)));
  content_.messages.push_back(message);
}

void ChunkedBag::add_compression(Compression compression) {
  if (compression == Compression::none) return;
  const std::string name(to_string(compression));
  if (std::ranges::find(content_.compression, name) == content_.compression.end()) content_.compression.push_back(name);
}

void ChunkedBag::add_broken(std::uint64_t record, const std::string& why) {
  if (broken_++ == 0) first_broken_ = "the one at byte " + std::to_string(record) + " " + why;
}

void ChunkedBag::finish_scan() {
  if (skipped_ > 0) {
    add_damage(std::to_string(skipped_) + " chunks were not read: the chunks exceed " +
               std::to_string(max_decompressed_ >> 20) +
               " MB when decompressed; if the bag is intact, record without compression");
  }
  if (broken_ > 0) {
    add_damage(std::to_string(broken_) + (broken_ == 1 ? " record is damaged: " : " records are damaged: ") +
               first_broken_);
  }
  std::ranges::stable_sort(content_.messages, {}, &BagMessage::log_time);
  content_.messages.shrink_to_fit();
}

std::string truncation_text(std::uint64_t begin, std::uint64_t size) {
  return "is truncated or damaged from byte " + std::to_string(begin) + " of " + std::to_string(size) +
         " on; the part before was read";
}

}  // namespace byre
