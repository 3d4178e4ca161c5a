#pragma once

#include "byre/image_condition.h"
#include "byre/rig.h"
#include "byre/tag.h"
#include "byre/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace byre {

struct Image;

using Descriptor = std::array<std::uint64_t, 4>;  // 256-bit rotated BRIEF; bit i of byte j as packed by cv::ORB

// Scale pyramid: octave o is the image scaled down by kOctaveScale^o.
inline constexpr int kOctaves = 8;
inline constexpr double kOctaveScale = 1.2;
inline constexpr std::array<float, kOctaves> kScaleOfOctave = {1.0f,    1.2f,     1.44f,     1.728f,
                                                               2.0736f, 2.48832f, 2.985984f, 3.5831808f};

// Detected corner in the left rectified image.
struct Keypoint {
  Eigen::Vector2f pixel;          // full-resolution pixels; centre of its patch, with sub-pixel precision
  float disparity = -1.0f;        // pixels; negative without a match in the right image
  float disparity_sigma = -1.0f;  // pixels
  float row_offset = 0.0f;  // row in the right image minus row in the left one, pixels; zero for a perfect calibration
  float angle = 0.0f;       // orientation by the intensity centroid, radians (Rublee 2011)
  float response = 0.0f;    // corner strength; larger is stronger
  float row_time = 0.0f;    // time of its row after the middle row, -0.5 to 0.5 readout times
  std::uint8_t octave = 0;

  bool has_disparity() const { return disparity > 0.0f; }
};

// Grey values around a keypoint in its octave. Kept for sub-pixel refinement of later matches without the image.
struct Patch {
  static constexpr int kSize = 16;                   // octave pixels
  std::array<std::uint8_t, kSize * kSize> pixels{};  // row-major
  Eigen::Vector2f centre;  // position of the keypoint in the patch, octave pixels; near (8, 8)
};

// Copies the items of a view.
template <typename Item>
std::vector<Item> to_vector(std::span<const Item> items) {
  return {items.begin(), items.end()};
}

// Keypoints with descriptors and patches of one image, sorted by grid cell for fast area queries. Returned views are
// valid as long as the features.
class Features {
 public:
  Features() = default;
  // Sorts all lists by grid cell. patches may be empty (simulated features): matches then keep the precision of the
  // keypoints. Preconditions: equal sizes; keypoints lie in the image.
  Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
           std::vector<Patch> patches);
  // With patches for some keypoints only. patch_of_keypoint: one index into patches per keypoint, or -1.
  Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
           std::vector<Patch> patches, std::vector<int> patch_of_keypoint);

  // Same result as the constructor, reusing allocated memory.
  void refill(int width, int height, const std::vector<Keypoint>& keypoints, const std::vector<Descriptor>& descriptors,
              const std::shared_ptr<const std::vector<Patch>>& patches);

  // Sorting order that the constructor applies: indices into keypoints.
  static std::vector<int> order_of(int width, int height, const std::vector<Keypoint>& keypoints);

  // Copy with other keypoints: the same corners in the same order, slightly displaced. Precondition: equal number.
  Features moved(std::vector<Keypoint> keypoints) const;
  // Same result as features.moved(keypoints), reusing allocated memory.
  void refill_moved(const Features& features, std::span<const Keypoint> keypoints);

  // Copy that keeps patches of these features only. Precondition: indices, ascending.
  Features with_patches_of(std::span<const int> features) const;

  // Bytes of all arrays, to be stored elsewhere, and a copy of the features that refers to stored arrays. An array with
  // a null place is copied. Precondition: places hold copies of what arrays() returns, equally aligned.
  static constexpr std::size_t kArrays = 5;
  std::array<std::span<const std::byte>, kArrays> arrays() const;
  Features with_arrays_at(const std::array<std::shared_ptr<const std::byte>, kArrays>& places) const;

  int size() const { return static_cast<int>(keypoints().size()); }
  std::span<const Keypoint> keypoints() const { return keypoints_.view(); }
  std::span<const Descriptor> descriptors() const { return descriptors_.view(); }
  const Keypoint& keypoint(int i) const { return keypoints()[static_cast<std::size_t>(i)]; }
  const Descriptor& descriptor(int i) const { return descriptors()[static_cast<std::size_t>(i)]; }
  // Patch of a keypoint; nullptr if it was not kept.
  const Patch* find_patch(int i) const {
    const std::span<const int> indices = patch_of_keypoint_.view();
    const int patch = indices.empty() ? -1 : indices[static_cast<std::size_t>(i)];
    return patch < 0 ? nullptr : patches().data() + patch;
  }
  // All kept patches, in no particular order.
  std::span<const Patch> patches() const { return patches_.view(); }

  // Calls visit(index) for each keypoint in octaves [min_octave, max_octave] whose column and row differ from the
  // pixel's by at most radius pixels. Order: ascending rows of cells.
  template <typename Visitor>
  void visit_area(const Eigen::Vector2f& pixel, float radius, int min_octave, int max_octave, Visitor visit) const;

 private:
  // Array that owns its items or refers to shared ones.
  template <typename Item>
  class Items {
   public:
    Items() = default;
    Items(const Items& other) { *this = other; }
    Items(Items&& other) noexcept { *this = std::move(other); }
    ~Items() = default;
    Items& operator=(const Items& other) {
      if (this == &other) return *this;
      owned_ = other.owned_;
      shared_ = other.shared_;
      view_ = shared_ ? other.view_ : owned_;
      return *this;
    }
    Items& operator=(Items&& other) noexcept {
      owned_ = std::exchange(other.owned_, {});
      shared_ = std::exchange(other.shared_, {});
      view_ = std::exchange(other.view_, {});
      return *this;
    }

    // Refers to count shared items.
    Items(std::shared_ptr<const Item> shared, std::size_t count)
        : shared_(std::move(shared)), view_(shared_.get(), count) {}
    // Refers to the same number of items at a place; a copy if the place is null.
    Items at(const std::shared_ptr<const std::byte>& place) const {
      if (!place) return *this;
      return {{place, reinterpret_cast<const Item*>(place.get())}, view_.size()};
    }

    std::span<const Item> view() const { return view_; }
    // Calls fill to write own items into allocated memory.
    template <typename Fill>
    void refill(Fill fill) {
      shared_.reset();
      fill(owned_);
      view_ = owned_;
    }
    void take(std::vector<Item> items) {
      refill([&](std::vector<Item>& own) { own = std::move(items); });
    }

   private:
    std::vector<Item> owned_;  // empty if items are shared
    std::shared_ptr<const Item> shared_;
    std::span<const Item> view_;
  };

  void update_slack(std::span<const Keypoint> keypoints);
  void set_patches(const std::shared_ptr<const std::vector<Patch>>& patches);

  int cell_size_ = 0;  // pixels
  int columns_ = 0;
  int rows_ = 0;
  float slack_ = 0.0f;  // largest displacement of a keypoint out of its cell, pixels
  Items<Keypoint> keypoints_;
  Items<Descriptor> descriptors_;
  Items<Patch> patches_;  // shared with displaced copies
  Items<int> patch_of_keypoint_;
  Items<int> cell_begin_;  // index of the first keypoint of each cell, then the number of keypoints
};

// Front-end result of one mono, stereo or RGB-D image: features without pixels. Immutable once made.
struct Frame {
  Timestamp time{};
  std::shared_ptr<const Features> features;
  std::optional<ImageCondition> condition = {};        // condition of the left image; empty for simulated frames
  std::optional<ImageCondition> right_condition = {};  // condition of the right image; empty without one
  std::uint64_t content = 0;                           // checksum of the left image's pixels; 0 for simulated frames
  std::vector<TagSighting> tags = {};                  // tags detected; empty as well if detection was not due
  std::shared_ptr<const Image> picture = {};           // left image, rectified and reduced; null unless extracted
};

template <typename Visitor>
void Features::visit_area(const Eigen::Vector2f& pixel, float radius, int min_octave, int max_octave,
                          Visitor visit) const {
  const auto cell = [this](float coordinate, int count) {
    constexpr float kFar = 1e6f;  // beyond any image, but fits an int; NaN counts as zero
    return std::min(static_cast<int>(std::min(std::max(0.0f, coordinate), kFar)) / cell_size_, count - 1);
  };
  if (columns_ == 0) return;
  const float reach = radius + slack_;
  const int first_column = cell(pixel.x() - reach, columns_);
  const int last_column = cell(pixel.x() + reach, columns_);
  const int last_row = cell(pixel.y() + reach, rows_);
  // Branch-free, as membership is unpredictable: all indices of a cell are written, those outside are overwritten.
  constexpr std::size_t kAtOnce = 64;
  std::array<int, kAtOnce> inside;
  std::size_t count = 0;
  const auto visit_all = [&] {
    for (std::size_t i = 0; i < count; ++i) visit(inside[i]);
    count = 0;
  };
  for (int row = cell(pixel.y() - reach, rows_); row <= last_row; ++row) {
    const int begin = cell_begin_.view()[static_cast<std::size_t>(row * columns_ + first_column)];
    const int end = cell_begin_.view()[static_cast<std::size_t>(row * columns_ + last_column + 1)];
    for (int i = begin; i < end; ++i) {
      const Keypoint& candidate = keypoint(i);
      const auto is_outside = static_cast<int>(candidate.octave < min_octave) |
                              static_cast<int>(candidate.octave > max_octave) |
                              static_cast<int>(std::abs(candidate.pixel.x() - pixel.x()) > radius) |
                              static_cast<int>(std::abs(candidate.pixel.y() - pixel.y()) > radius);
      inside[count] = i;
      count += static_cast<std::size_t>(1 - is_outside);
      if (count == kAtOnce) visit_all();
    }
  }
  visit_all();
}

}  // namespace byre
