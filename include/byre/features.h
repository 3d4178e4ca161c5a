#pragma once

#include "byre/image_condition.h"
#include "byre/rig.h"
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

using Descriptor = std::array<std::uint64_t, 4>;  // 256-bit rotated BRIEF, bit i of byte j as cv::ORB packs them

// The scale pyramid: octave o is smaller than the image by kOctaveScale^o.
inline constexpr int kOctaves = 8;
inline constexpr double kOctaveScale = 1.2;
inline constexpr std::array<float, kOctaves> kScaleOfOctave = {1.0f,    1.2f,     1.44f,     1.728f,
                                                               2.0736f, 2.48832f, 2.985984f, 3.5831808f};

// A detected corner, in the left rectified image.
struct Keypoint {
  Eigen::Vector2f pixel;          // full-resolution pixels; centre of its patch to sub-pixel precision
  float disparity = -1.0f;        // pixels, negative when not matched in the right image
  float disparity_sigma = -1.0f;  // pixels
  float row_offset = 0.0f;        // pixels, right less left row of its match, zero if all is calibrated
  float angle = 0.0f;             // radians, of the intensity centroid (Rublee 2011)
  float response = 0.0f;          // corner strength, larger is better
  float row_time = 0.0f;          // reading time of its row, from the middle row on: -0.5 to 0.5 times the readout time
  std::uint8_t octave = 0;

  bool has_disparity() const { return disparity > 0.0f; }
};

// The grey values around a keypoint in its own octave, kept so that matches can be refined to sub-pixel later,
// long after the image is gone.
struct Patch {
  static constexpr int kSize = 16;                   // octave pixels
  std::array<std::uint8_t, kSize * kSize> pixels{};  // row-major
  Eigen::Vector2f centre;                            // place of the keypoint in the patch, octave pixels, near (8, 8)
};

// A list of one's own of what a view shows.
template <typename Item>
std::vector<Item> to_vector(std::span<const Item> items) {
  return {items.begin(), items.end()};
}

// Keypoints, their descriptors and patches, one each; sorted by grid cell, so that an area is a few short ranges.
// Views of them last as long as the features do.
class Features {
 public:
  Features() = default;
  // patches may be empty (simulated features): then matches keep the precision of the keypoints.
  // Reorders all three by grid cell. Precondition: equal sizes; keypoints lie in the image.
  Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
           std::vector<Patch> patches);
  // With patches of some keypoints only: patch_of_keypoint is an index into patches, or -1. Sized like keypoints.
  Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
           std::vector<Patch> patches, std::vector<int> patch_of_keypoint);

  // Becomes what the constructor makes of these, in the memory that it has.
  void refill(int width, int height, const std::vector<Keypoint>& keypoints, const std::vector<Descriptor>& descriptors,
              const std::shared_ptr<const std::vector<Patch>>& patches);

  // The order that features have: that of the constructor, indices into keypoints in any other.
  static std::vector<int> order_of(int width, int height, const std::vector<Keypoint>& keypoints);

  // The same corners in the same order, each a little elsewhere in the image. Precondition: as many as there are.
  Features moved(std::vector<Keypoint> keypoints) const;
  // Becomes the same in the memory that it has.
  void refill_moved(const Features& features, const std::vector<Keypoint>& keypoints);

  // The same, but for the patches of other features. Precondition: indices, ascending.
  Features with_patches_of(std::span<const int> features) const;

  // All that takes memory, list by list, and the same features whose lists lie elsewhere. A list without another place
  // stays where it is. Precondition: copies of what lists() shows, aligned as that is.
  static constexpr std::size_t kLists = 5;
  std::array<std::span<const std::byte>, kLists> lists() const;
  Features with_lists_at(const std::array<std::shared_ptr<const std::byte>, kLists>& places) const;

  int size() const { return static_cast<int>(keypoints().size()); }
  std::span<const Keypoint> keypoints() const { return keypoints_.view(); }
  std::span<const Descriptor> descriptors() const { return descriptors_.view(); }
  const Keypoint& keypoint(int i) const { return keypoints()[static_cast<std::size_t>(i)]; }
  const Descriptor& descriptor(int i) const { return descriptors()[static_cast<std::size_t>(i)]; }
  // nullptr where none was kept: a patch takes several times the memory of all the rest.
  const Patch* find_patch(int i) const {
    const std::span<const int> indices = patch_of_keypoint_.view();
    const int patch = indices.empty() ? -1 : indices[static_cast<std::size_t>(i)];
    return patch < 0 ? nullptr : patches().data() + patch;
  }
  // Those that were kept, in any order.
  std::span<const Patch> patches() const { return patches_.view(); }

  // Calls visit(index) for each keypoint within radius (pixels, per axis) of a pixel whose octave lies in
  // [min_octave, max_octave], in ascending order of rows of cells.
  template <typename Visitor>
  void visit_area(const Eigen::Vector2f& pixel, float radius, int min_octave, int max_octave, Visitor visit) const;

 private:
  // Items of its own, or such as lie elsewhere, which copies share.
  template <typename Item>
  class Items {
   public:
    Items() = default;
    Items(const Items& other) { *this = other; }
    Items(Items&& other) noexcept { *this = std::move(other); }
    ~Items() = default;
    Items& operator=(const Items& other) {
      if (this == &other) return *this;
      own_ = other.own_;
      elsewhere_ = other.elsewhere_;
      view_ = elsewhere_ ? other.view_ : own_;
      return *this;
    }
    Items& operator=(Items&& other) noexcept {
      own_ = std::exchange(other.own_, {});
      elsewhere_ = std::exchange(other.elsewhere_, {});
      view_ = std::exchange(other.view_, {});
      return *this;
    }

    // As many of them that lie elsewhere.
    Items(std::shared_ptr<const Item> elsewhere, std::size_t count)
        : elsewhere_(std::move(elsewhere)), view_(elsewhere_.get(), count) {}
    // The same at that place, if there is one.
    Items at(const std::shared_ptr<const std::byte>& place) const {
      if (!place) return *this;
      return {{place, reinterpret_cast<const Item*>(place.get())}, view_.size()};
    }

    std::span<const Item> view() const { return view_; }
    // Has fill write items of its own, in the memory that it has.
    template <typename Fill>
    void refill(Fill fill) {
      elsewhere_.reset();
      fill(own_);
      view_ = own_;
    }
    void take(std::vector<Item> items) {
      refill([&](std::vector<Item>& own) { own = std::move(items); });
    }

   private:
    std::vector<Item> own_;  // empty where they lie elsewhere
    std::shared_ptr<const Item> elsewhere_;
    std::span<const Item> view_;
  };

  void note_moves(std::span<const Keypoint> keypoints);
  void take_patches(const std::shared_ptr<const std::vector<Patch>>& patches);

  int cell_size_ = 0;  // pixels
  int columns_ = 0;
  int rows_ = 0;
  float slack_ = 0.0f;  // pixels by which a keypoint may have left its cell
  Items<Keypoint> keypoints_;
  Items<Descriptor> descriptors_;
  Items<Patch> patches_;  // elsewhere: shared with copies that were moved
  Items<int> patch_of_keypoint_;
  Items<int> cell_begin_;  // index of each cell's first keypoint, and one past the last
};

// What the rest of byre sees of one (stereo) image: never pixels, never changed once made.
struct Frame {
  Timestamp time{};
  std::shared_ptr<const Features> features;
  std::optional<ImageCondition> condition = {};        // what the left image is like; empty for simulated frames
  std::optional<ImageCondition> right_condition = {};  // what the right image is like, where there is one
  std::uint64_t content = 0;                           // checksum of the left image's pixels; 0 for simulated frames
};

template <typename Visitor>
void Features::visit_area(const Eigen::Vector2f& pixel, float radius, int min_octave, int max_octave,
                          Visitor visit) const {
  const auto cell = [this](float coordinate, int count) {
    constexpr float kFar = 1e6f;  // beyond any image, yet an int; what is no number counts as zero
    return std::min(static_cast<int>(std::min(std::max(0.0f, coordinate), kFar)) / cell_size_, count - 1);
  };
  if (columns_ == 0) return;
  const float reach = radius + slack_;
  const int first_column = cell(pixel.x() - reach, columns_);
  const int last_column = cell(pixel.x() + reach, columns_);
  const int last_row = cell(pixel.y() + reach, rows_);
  // Whether a keypoint lies in the area is as good as drawn. So no branch depends on it: all of a cell are written
  // down, and those outside are written over.
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
