#include "byre/slam/window/paged_features.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace byre {

// The lists are one block in the file, which is freed as a whole.
std::shared_ptr<const Features> page_out(const std::shared_ptr<const Features>& features, ScratchFile& file) {
  constexpr std::size_t kAlignment = 64;  // bytes, of each list
  if (!features) return features;
  std::array<std::size_t, Features::kArrays> begins{};
  std::size_t end = 0;
  const auto lists = features->arrays();
  const auto is_to_move = [&](std::span<const std::byte> list) { return !list.empty() && !file.holds(list.data()); };
  for (std::size_t i = 0; i < lists.size(); ++i) {
    begins[i] = end;
    if (is_to_move(lists[i])) end += (lists[i].size() + kAlignment - 1) / kAlignment * kAlignment;
  }
  if (end == 0) return features;

  std::vector<std::byte> bytes(end);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (is_to_move(lists[i])) std::ranges::copy(lists[i], bytes.begin() + static_cast<std::ptrdiff_t>(begins[i]));
  }
  const std::shared_ptr<const std::byte> piece = file.put(bytes);
  if (!piece) return features;
  std::array<std::shared_ptr<const std::byte>, Features::kArrays> places;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (is_to_move(lists[i])) places[i] = {piece, piece.get() + begins[i]};
  }
  return std::make_shared<const Features>(features->with_arrays_at(places));
}

void page_out_features(MapGraph& map, ScratchFile& file) {
  for (const KeyframeId id : map.keyframe_ids()) {
    map.replace_features(id, page_out(map.find_keyframe(id)->frame.features, file));
  }
}

std::function<bool()> releasing_pages(const ScratchFile& file, std::function<bool()> should_stop) {
  return [&file, should_stop = std::move(should_stop)] {
    file.release_pages();
    return should_stop && should_stop();
  };
}

}  // namespace byre
