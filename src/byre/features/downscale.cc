#include "byre/features/pyramid.h"

#include "byre/base/scratch_memory.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

// The vectorised part of this file is compiled once for each instruction set with vectors made of 16-byte blocks.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/downscale.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "byre/features/pairwise_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

// Interpolates the pixels of a row between two source pixels each: 128 times the grey value.
void scale_row(const std::uint8_t* source, const Downscale::Group* groups, std::size_t count, std::int16_t* sums) {
  const hn::CappedTag<std::uint8_t, 32> d8;
  const hn::Repartition<std::int16_t, decltype(d8)> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  const hn::Rebind<std::int16_t, decltype(d32)> made;
  constexpr std::size_t kBytes = 4 * Downscale::Group::kPixels;
  for (std::size_t g = 0; g < count; ++g, sums += Downscale::Group::kPixels) {
    const auto pixels = hn::LoadDup128(d8, source + groups[g].first);
    for (std::size_t i = 0; i < kBytes; i += hn::Lanes(d8)) {
      const auto chosen = hn::TableLookupBytesOr0(pixels, hn::LoadU(d8, groups[g].neighbours.data() + i));
      const auto sum = pairwise_sums(d32, hn::BitCast(d16, chosen), hn::LoadU(d16, groups[g].weights.data() + i / 2));
      hn::StoreU(hn::DemoteTo(made, hn::ShiftRight<4>(sum)), made, sums + i / 4);
    }
  }
}

// Interpolates between two such rows, with weights that sum to 2048.
void blend_rows(const std::int16_t* upper, const std::int16_t* lower, std::int16_t upper_weight,
                std::int16_t lower_weight, std::size_t width, std::uint8_t* made) {
  const hn::ScalableTag<std::int16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const auto of_upper = hn::Set(d16, upper_weight), of_lower = hn::Set(d16, lower_weight);
  const std::size_t lanes = hn::Lanes(d16);
  std::size_t x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto sum =
        hn::Add(hn::MulHigh(hn::LoadU(d16, upper + x), of_upper), hn::MulHigh(hn::LoadU(d16, lower + x), of_lower));
    hn::StoreU(hn::DemoteTo(d8, hn::ShiftRight<2>(hn::Add(sum, hn::Set(d16, 2)))), d8, made + x);
  }
  for (; x < width; ++x) {
    const int sum = (upper[x] * upper_weight >> 16) + (lower[x] * lower_weight >> 16);
    made[x] = static_cast<std::uint8_t>(std::min((sum + 2) >> 2, 255));
  }
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(scale_row);
HWY_EXPORT(blend_rows);

constexpr int kReadAtOnce = 16;  // pixels of a row
constexpr float kOne = 2048.0f;  // sum of two weights

// Interpolation between two neighbours of a row or column.
struct Place {
  int first = 0;
  int second = 0;
  std::int16_t first_weight = 0;
  std::int16_t second_weight = 0;
};

// Pixels on the border are their own neighbours.
Place source_place(int made, double factor, int size) {
  const auto coordinate = static_cast<float>((made + 0.5) * factor - 0.5);
  const float first = std::floor(coordinate);
  const float fraction = coordinate - first;
  const auto inside = [size](int pixel) { return std::clamp(pixel, 0, size - 1); };
  return {inside(static_cast<int>(first)), inside(static_cast<int>(first) + 1),
          cv::saturate_cast<std::int16_t>((1.0f - fraction) * kOne), cv::saturate_cast<std::int16_t>(fraction * kOne)};
}

}  // namespace

Downscale::Downscale(cv::Size source, double factor)
    : source_(source),
      size_(cv::saturate_cast<int>(source.width * (1.0 / factor)),
            cv::saturate_cast<int>(source.height * (1.0 / factor))) {
  assert(factor > 1.0 && factor <= kMaxFactor && std::min(source.width, source.height) >= kMinSide);
  const double scale = 1.0 / (1.0 / factor);  // rounding of cv::resize
  for (int u = 0; u < size_.width; u += Group::kPixels) {
    Group group;
    group.first = std::min(source_place(u, scale, source.width).first, source.width - kReadAtOnce);
    for (int i = 0; i < Group::kPixels && u + i < size_.width; ++i) {
      const Place place = source_place(u + i, scale, source.width);
      const auto at = static_cast<std::size_t>(i);
      constexpr std::uint8_t kNothing = 0x80;  // for the upper byte of 16 bits
      const auto neighbour = [&](int column) { return static_cast<std::uint8_t>(column - group.first); };
      group.neighbours[4 * at] = neighbour(place.first);
      group.neighbours[4 * at + 2] = neighbour(place.second);
      group.neighbours[4 * at + 1] = group.neighbours[4 * at + 3] = kNothing;
      group.weights[2 * at] = place.first_weight;
      group.weights[2 * at + 1] = place.second_weight;
    }
    groups_.push_back(group);
  }
  for (int v = 0; v < size_.height; ++v) {
    const Place place = source_place(v, scale, source.height);
    rows_.push_back({place.first, place.second, place.first_weight, place.second_weight});
  }
}

void Downscale::apply(const cv::Mat& image, cv::Mat& made) const {
  assert(image.type() == CV_8U && image.size() == source_);
  made.create(size_, CV_8U);
  std::array<ScratchVector<std::int16_t>, 2> sums;  // the last two scaled rows
  std::array<int, 2> made_of = {-1, -1};
  for (ScratchVector<std::int16_t>& row : sums) row.resize(groups_.size() * Group::kPixels);
  const auto sums_of = [&](int row) {
    const auto slot = static_cast<std::size_t>(row % 2);
    if (made_of[slot] != row) {
      HWY_DYNAMIC_DISPATCH(scale_row)(image.ptr<std::uint8_t>(row), groups_.data(), groups_.size(), sums[slot].data());
      made_of[slot] = row;
    }
    return sums[slot].data();
  };
  for (int v = 0; v < size_.height; ++v) {
    const Row& row = rows_[static_cast<std::size_t>(v)];
    HWY_DYNAMIC_DISPATCH(blend_rows)
    (sums_of(row.upper), sums_of(row.lower), row.upper_weight, row.lower_weight, static_cast<std::size_t>(size_.width),
     made.ptr<std::uint8_t>(v));
  }
}

}  // namespace byre

#endif
