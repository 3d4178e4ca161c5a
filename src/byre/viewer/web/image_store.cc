#include "byre/viewer/web/image_store.h"

#include <iterator>
#include <utility>

namespace byre {

void ImageStore::add(std::size_t frame, std::string bytes) {
  bytes_ += bytes.size();
  const auto [place, is_new] = images_.try_emplace(frame);
  bytes_ -= place->second.size();
  place->second = std::move(bytes);
  while (bytes_ > max_bytes_ && images_.size() > 2) thin_out();
}

void ImageStore::thin_out() {
  const std::size_t older = images_.size() / 2;
  auto image = images_.begin();
  for (std::size_t i = 0; i < older; i += 2) {
    ++image;  // keeps the first image
    bytes_ -= image->second.size();
    image = images_.erase(image);
  }
}

const std::string* ImageStore::find_nearest(std::size_t frame) const {
  if (images_.empty()) return nullptr;
  const auto after = images_.lower_bound(frame);
  if (after == images_.end()) return &images_.rbegin()->second;
  if (after == images_.begin() || after->first == frame) return &after->second;
  const auto before = std::prev(after);
  return frame - before->first <= after->first - frame ? &before->second : &after->second;
}

}  // namespace byre
