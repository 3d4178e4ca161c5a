#include "byre/features/tag_detector.h"

#include <cassert>
#include <cstdlib>

#include <apriltag/apriltag.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagStandard41h12.h>

namespace byre {
namespace {

using FamilyPointer = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

FamilyPointer make_family(TagFamily family) {
  switch (family) {
    case TagFamily::tag36h11:
      return {tag36h11_create(), &tag36h11_destroy};
    case TagFamily::tag25h9:
      return {tag25h9_create(), &tag25h9_destroy};
    case TagFamily::tag_standard41h12:
      break;
  }
  return {tagStandard41h12_create(), &tagStandard41h12_destroy};
}

TagSighting sighting_of(const apriltag_detection_t& found, TagFamily family) {
  TagSighting sighting{{family, found.id}, {}};
  // libapriltag lists the corners against the clock from the lower left one. Its pixel centres are at halves.
  constexpr std::array<std::size_t, 4> kOrder = {3, 2, 1, 0};
  for (std::size_t i = 0; i < kOrder.size(); ++i) {
    const auto& corner = found.p[kOrder[i]];
    sighting.corners[i] = {corner[0] - 0.5, corner[1] - 0.5};
  }
  return sighting;
}

}  // namespace

struct TagDetector::State {
  std::vector<std::pair<TagFamily, FamilyPointer>> families;
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector{apriltag_detector_create(),
                                                                                &apriltag_detector_destroy};
  std::vector<std::uint8_t> pixels;  // working memory, as libapriltag needs a row stride of its own

  TagFamily family_of(const apriltag_detection_t& found) const {
    const auto known =
        std::ranges::find_if(families, [&](const auto& each) { return each.second.get() == found.family; });
    assert(known != families.end());
    return known->first;
  }
};

bool can_detect_tags() {
  return true;
}

TagDetector::TagDetector(std::span<const TagFamily> families) : state_(new State) {
  constexpr int kCorrectedBits = 1;
  for (const TagFamily family : families) {
    state_->families.emplace_back(family, make_family(family));
    apriltag_detector_add_family_bits(state_->detector.get(), state_->families.back().second.get(), kCorrectedBits);
  }
  state_->detector->nthreads = 1;
}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

bool TagDetector::has_families() const {
  return !state_->families.empty();
}

std::vector<TagSighting> TagDetector::detect(const ImageView& image) {
  if (state_->families.empty()) return {};
  constexpr int kLarge = 200'000;  // pixels; a coarser grid halves the time there, and finds nine of ten tags
  state_->detector->quad_decimate = image.width * image.height > kLarge ? 1.5F : 1.0F;
  constexpr float kLeastMargin = 25.0F;  // grey values between bits and the threshold: weaker ones are mostly clutter
  const auto* const first = static_cast<const std::uint8_t*>(image.data);
  const auto width = static_cast<std::size_t>(image.width);
  const std::size_t stride = image.stride != 0 ? image.stride : width;
  state_->pixels.resize(width * static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row) {
    const auto at = static_cast<std::size_t>(row);
    std::copy_n(first + at * stride, width, state_->pixels.data() + at * width);
  }
  image_u8_t view{image.width, image.height, image.width, state_->pixels.data()};
  const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(apriltag_detector_detect(state_->detector.get(), &view),
                                                             &apriltag_detections_destroy);
  std::vector<TagSighting> sightings;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    if (detection->decision_margin < kLeastMargin) continue;
    sightings.push_back(sighting_of(*detection, state_->family_of(*detection)));
  }
  std::ranges::sort(sightings, {}, &TagSighting::id);
  const std::vector<TagSighting> all = sightings;
  std::erase_if(sightings,
                [&](const TagSighting& each) { return std::ranges::count(all, each.id, &TagSighting::id) > 1; });
  return sightings;
}

int count_of(TagFamily family) {
  return static_cast<int>(make_family(family)->ncodes);
}

TagPicture tag_picture(const TagId& id) {
  const FamilyPointer family = make_family(id.family);
  assert(id.number >= 0 && id.number < static_cast<int>(family->ncodes));
  struct Free {  // as image_u8_destroy, which the library does not export
    void operator()(image_u8_t* image) const {
      std::free(image->buf);
      std::free(image);
    }
  };
  const std::unique_ptr<image_u8_t, Free> drawn(apriltag_to_image(family.get(), id.number));
  TagPicture picture{{drawn->width, drawn->height, {}}, family->width_at_border};
  for (int row = 0; row < drawn->height; ++row) {
    const std::uint8_t* const pixels = drawn->buf + static_cast<std::ptrdiff_t>(row) * drawn->stride;
    picture.modules.pixels.insert(picture.modules.pixels.end(), pixels, pixels + drawn->width);
  }
  return picture;
}

}  // namespace byre
