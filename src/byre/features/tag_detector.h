#pragma once

#include "byre/image.h"
#include "byre/tag.h"

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

namespace byre {

// Whether byre was built with libapriltag.
bool can_detect_tags();

// Families of tags, ascending.
template <typename Tags>
std::vector<TagFamily> families_of(const Tags& tags) {
  std::vector<TagFamily> families;
  for (const auto& tag : tags) families.push_back(tag.id.family);
  std::ranges::sort(families);
  families.erase(std::ranges::unique(families).begin(), families.end());
  return families;
}

// Detects AprilTags of some families by libapriltag (Wang and Olson 2016). Not thread-safe.
class TagDetector {
 public:
  // Without families, and if byre was built without libapriltag, it detects none at no cost.
  explicit TagDetector(std::span<const TagFamily> families);
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  bool has_families() const;
  // Tags in a rectified grey8 image, by id. Leaves out ids that are seen twice.
  std::vector<TagSighting> detect(const ImageView& image);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

int count_of(TagFamily family);  // tags of a family; 0 without libapriltag

// The tag's modules with its white margin, one pixel each. edge: of the square between the corners, in modules.
struct TagPicture {
  Image modules;
  int edge = 0;
};
TagPicture tag_picture(const TagId& id);

}  // namespace byre
