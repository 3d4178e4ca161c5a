#include "byre/features/remap.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

// The vectorised part of this file is compiled once for each instruction set with vectors made of 16-byte blocks.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/remap.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "byre/features/pairwise_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

using D16 = hn::CappedTag<std::int16_t, 16>;
using D8 = hn::Repartition<std::uint8_t, D16>;

constexpr std::size_t kPixelsOfGroup = 8;

// Loads the source bytes of neighbouring groups: sixteen at each offset.
template <class D>
HWY_INLINE hn::Vec<D> bytes_at(D d, const std::uint8_t* source, const std::ptrdiff_t* offsets) {
  if constexpr (hn::MaxLanes(D()) == 32) {
    const hn::Half<D> half;
    return hn::Combine(d, hn::LoadU(half, source + offsets[1]), hn::LoadU(half, source + offsets[0]));
  } else {
    return hn::LoadU(d, source + offsets[0]);
  }
}

// Positions and weights of a vector of groups within the bytes of a row.
struct Columns {
  hn::Vec<D8> left;
  hn::Vec<D8> right;
  hn::Vec<D16> left_weight;
  hn::Vec<D16> right_weight;

  // Interpolates between the two columns: 32 times the grey value.
  HWY_INLINE hn::Vec<D16> in(hn::Vec<D8> bytes) const {
    const D16 d;
    return hn::Add(hn::Mul(hn::BitCast(d, hn::TableLookupBytesOr0(bytes, left)), left_weight),
                   hn::Mul(hn::BitCast(d, hn::TableLookupBytesOr0(bytes, right)), right_weight));
  }
};

HWY_INLINE Columns columns_of(hn::Vec<hn::RebindToUnsigned<D16>> places) {
  const D16 d;
  const D8 d8;
  const hn::RebindToUnsigned<D16> du;
  const auto fraction = hn::BitCast(d, hn::And(places, hn::Set(du, 31)));
  // The upper byte stays empty.
  const auto left = hn::Or(hn::And(hn::ShiftRight<10>(places), hn::Set(du, 15)), hn::Set(du, 0x8000));
  return {hn::BitCast(d8, left), hn::BitCast(d8, hn::Add(left, hn::Set(du, 1))), hn::Sub(hn::Set(d, 32), fraction),
          fraction};
}

// Computes all pixels of at least two groups. Does not read rows beyond the last offset.
void look_up(const std::uint8_t* source, std::ptrdiff_t stride, std::ptrdiff_t last, const std::int32_t* first,
             const std::uint8_t* rows, const std::uint16_t* places, std::size_t groups, std::uint8_t* made) {
  const D16 d;
  const D8 d8;
  const hn::RebindToUnsigned<D16> du;
  const hn::RepartitionToWide<D16> d32;
  const hn::Rebind<std::uint8_t, D16> d_made;
  const std::size_t at_once = hn::Lanes(d) / kPixelsOfGroup;
  for (std::size_t g = 0; g < groups; g += at_once) {
    // The last groups overlap with the previous ones.
    const std::size_t at = std::min(g, groups - at_once);
    const auto place = hn::LoadU(du, places + at * kPixelsOfGroup);
    const Columns columns = columns_of(place);
    std::ptrdiff_t offsets[2] = {first[at], first[at + at_once - 1]};
    int row_count = std::max(rows[at], rows[at + at_once - 1]);
    auto upper = columns.in(bytes_at(d8, source, offsets)), lower = upper;
    const auto go_down = [&] {
      for (std::ptrdiff_t& offset : offsets) offset = std::min(offset + stride, last);
      return columns.in(bytes_at(d8, source, offsets));
    };
    lower = go_down();
    auto above = lower;
    for (int row = 1; row < row_count; ++row) {
      const auto below = go_down();
      const auto is_in_range =
          hn::MaskFromVec(hn::BitCast(d, hn::VecFromMask(du, hn::Eq(hn::ShiftRight<14>(place), hn::Set(du, row)))));
      upper = hn::IfThenElse(is_in_range, above, upper);
      lower = hn::IfThenElse(is_in_range, below, lower);
      above = below;
    }
    const auto down = hn::BitCast(d, hn::And(hn::ShiftRight<5>(place), hn::Set(du, 31)));
    const auto up = hn::Sub(hn::Set(d, 32), down);
    const auto half = hn::Set(d32, 512);
    const auto first_half =
        hn::Add(pairwise_sums(d32, hn::InterleaveLower(d, upper, lower), hn::InterleaveLower(d, up, down)), half);
    const auto second_half =
        hn::Add(pairwise_sums(d32, hn::InterleaveUpper(d, upper, lower), hn::InterleaveUpper(d, up, down)), half);
    const auto greys = hn::ReorderDemote2To(d, hn::ShiftRight<10>(first_half), hn::ShiftRight<10>(second_half));
    hn::StoreU(hn::DemoteTo(d_made, greys), d_made, made + at * kPixelsOfGroup);
  }
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(look_up);

constexpr int kSteps = 32;         // positions between two pixels
constexpr std::size_t kGroup = 8;  // pixels
constexpr int kBytesAtOnce = 16;   // source bytes read per row and group
constexpr int kMaxRows = 4;

struct Neighbours {
  int pixel = 0;     // always has a neighbour after it
  int fraction = 0;  // 0 to kSteps, distance towards that neighbour
};

// Clamps coordinates to the outermost pixels.
Neighbours neighbours_of(float coordinate, int size) {
  const float inside = std::min(std::max(coordinate, 0.0f), static_cast<float>(size - 1));
  const int steps = cvRound(inside * kSteps);
  if (steps / kSteps >= size - 1) return {size - 2, kSteps};
  return {steps / kSteps, steps % kSteps};
}

// A full fraction becomes the next pixel with fraction 0.
Neighbours without_whole_fraction(const Neighbours& found) {
  return found.fraction == kSteps ? Neighbours{found.pixel + 1, 0} : found;
}

}  // namespace

// Empty if its pixels are too far apart in the source.
struct Remap::Group {
  bool fits = false;
  std::int32_t first = 0;
  std::uint8_t rows = 0;
  std::array<std::uint16_t, kGroup> places{};
};

Remap::Group Remap::group_of(const SinglePixel* pixels, cv::Size source) {
  std::array<Neighbours, kGroup> columns, rows;
  for (std::size_t i = 0; i < kGroup; ++i) {
    columns[i] = without_whole_fraction({pixels[i].offset % source.width, pixels[i].column_fraction});
    rows[i] = without_whole_fraction({pixels[i].offset / source.width, pixels[i].row_fraction});
  }
  const auto [left, right] = std::ranges::minmax(columns, {}, &Neighbours::pixel);
  const auto [top, bottom] = std::ranges::minmax(rows, {}, &Neighbours::pixel);
  const int row_count = bottom.pixel - top.pixel + 1;
  // Rows below the last one are not readable, and have no weight.
  const bool is_last_row = bottom.pixel == source.height - 1;
  const int last = source.area() - kBytesAtOnce;
  const int first = top.pixel * source.width + left.pixel;
  const int beyond = std::max(0, first + (is_last_row ? row_count - 1 : row_count) * source.width - last);
  if (row_count > kMaxRows || first < beyond || right.pixel - left.pixel + beyond + 1 >= kBytesAtOnce) return {};
  Group group{true, first - beyond, static_cast<std::uint8_t>(row_count), {}};
  for (std::size_t i = 0; i < kGroup; ++i) {
    const int column = columns[i].pixel - left.pixel + beyond, row = rows[i].pixel - top.pixel;
    group.places[i] =
        static_cast<std::uint16_t>(columns[i].fraction | rows[i].fraction << 5 | column << 10 | row << 14);
  }
  return group;
}

void Remap::add(const SinglePixel* pixels) {
  const Group group = group_of(pixels, source_);
  if (!group.fits) singles_.insert(singles_.end(), pixels, pixels + kGroup);
  first_.push_back(group.first);
  rows_.push_back(group.rows);
  places_.insert(places_.end(), group.places.begin(), group.places.end());
}

Remap::Remap(const cv::Mat& columns, const cv::Mat& rows, cv::Size source) : size_(columns.size()), source_(source) {
  assert(columns.size() == rows.size() && source.width >= 2 && source.height >= 2);
  const auto count = static_cast<std::size_t>(size_.area());
  std::size_t groups = count / kGroup;
  if (groups < 2 || source.area() < kBytesAtOnce) groups = 0;
  first_.reserve(groups);
  rows_.reserve(groups);
  places_.reserve(groups * kGroup);
  std::array<SinglePixel, kGroup> waiting;
  for (std::size_t pixel = 0; pixel < count; ++pixel) {
    const int v = static_cast<int>(pixel) / size_.width, u = static_cast<int>(pixel) % size_.width;
    const Neighbours column = neighbours_of(columns.at<float>(v, u), source.width);
    const Neighbours row = neighbours_of(rows.at<float>(v, u), source.height);
    const SinglePixel single{pixel, row.pixel * source.width + column.pixel, column.fraction, row.fraction};
    if (pixel >= groups * kGroup) {
      singles_.push_back(single);
      continue;
    }
    waiting[pixel % kGroup] = single;
    if (pixel % kGroup == kGroup - 1) add(waiting.data());
  }
}

int Remap::source_row(cv::Point pixel) const {
  const auto index = static_cast<std::size_t>(pixel.y * size_.width + pixel.x);
  const std::size_t group = index / kGroup;
  if (group < rows_.size() && rows_[group] > 0) {
    const int column = places_[index] >> 10 & 15, row = places_[index] >> 14;
    return (first_[group] + column) / source_.width + row;
  }
  return std::ranges::lower_bound(singles_, index, {}, &SinglePixel::pixel)->offset / source_.width;
}

std::uint8_t Remap::value(const std::uint8_t* source, const SinglePixel& pixel) const {
  const std::uint8_t* const upper = source + pixel.offset;
  const std::uint8_t* const lower = upper + source_.width;
  const int column = pixel.column_fraction, row = pixel.row_fraction;
  const int above = (kSteps - column) * upper[0] + column * upper[1];
  const int below = (kSteps - column) * lower[0] + column * lower[1];
  return static_cast<std::uint8_t>(((kSteps - row) * above + row * below + kSteps * kSteps / 2) / (kSteps * kSteps));
}

void Remap::apply(const cv::Mat& image, cv::Mat& made) const {
  assert(image.type() == CV_8U && image.size() == source_ && image.isContinuous());
  made.create(size_, CV_8U);
  const std::uint8_t* const source = image.ptr<std::uint8_t>();
  std::uint8_t* const values = made.ptr<std::uint8_t>();
  if (!first_.empty()) {
    HWY_DYNAMIC_DISPATCH(look_up)
    (source, source_.width, source_.area() - kBytesAtOnce, first_.data(), rows_.data(), places_.data(), first_.size(),
     values);
  }
  for (const SinglePixel& pixel : singles_) values[pixel.pixel] = value(source, pixel);
}

}  // namespace byre

#endif
