#include "byre/features/tag_detector.h"

#include <cassert>

namespace byre {

struct TagDetector::State {};

bool can_detect_tags() {
  return false;
}

TagDetector::TagDetector(std::span<const TagFamily>) {}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

bool TagDetector::has_families() const {
  return false;
}

std::vector<TagSighting> TagDetector::detect(const ImageView&) {
  return {};
}

int count_of(TagFamily) {
  return 0;
}

TagPicture tag_picture(const TagId&) {
  assert(false);
  return {};
}

}  // namespace byre
