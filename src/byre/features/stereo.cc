#include "byre/features/stereo.h"

#include "byre/features/align_window.h"
#include "byre/features/block_differences.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace byre {
namespace {

constexpr int kLeftReach = kBlockColumns / 2;  // columns left of a block's middle
// Columns right of a block's middle: one more than is compared, see block_differences.
constexpr int kRightReach = kBlockColumns / 2;
constexpr int kRowReach = kBlockRows / 2;
constexpr int kAlignSize = 10;

const std::uint8_t* block(const cv::Mat& level, int x, int y) {
  return level.ptr<std::uint8_t>(y - kRowReach) + x - kLeftReach;
}

struct RowMatch {
  int x = -1;
  int cost = std::numeric_limits<int>::max();         // see cost_between_columns
  int second_cost = std::numeric_limits<int>::max();  // the best that is more than one pixel away

  bool is_unique(float max_ratio) const {
    // A grey value per pixel: too little to tell candidates apart.
    constexpr int kAllowance = kBlockColumns * kBlockRows;
    return static_cast<float>(cost + kAllowance) < max_ratio * static_cast<float>(second_cost);
  }
};

// Costs of neighbouring columns, between two that do not count.
using Costs = std::vector<std::uint16_t>;

// A minimum's cost at its place between the columns; the sum of absolute differences grows linearly to both sides of
// it. On whole columns a repeating pattern would seem unique wherever one of its copies happens to fall on a column.
int cost_between_columns(const std::uint16_t* cost) {
  const int left = cost[-1], here = cost[0], right = cost[1];
  const int between = std::max(0, here - std::abs(left - right) / 2);
  return here > std::min(left, right) ? here : between;
}

// The least cost between columns [first, last).
int least_between_columns(const std::uint16_t* first, const std::uint16_t* last) {
  int least = std::numeric_limits<int>::max();
  for (; first < last; ++first) least = std::min(least, cost_between_columns(first));
  return least;
}

// Costs of the block of `from` at (x, y) against those of `to` on columns [first, last] of the same row. Before the
// first and after the last stands a zero, below which no minimum lies.
void compare_with_row(const cv::Mat& from, int x, int y, const cv::Mat& to, int first, int last, Costs& costs) {
  costs.resize(static_cast<std::size_t>(last - first + 3));
  costs.front() = costs.back() = 0;
  std::uint16_t* out = costs.data() + 1;
  const auto stride = [](const cv::Mat& image) { return static_cast<std::ptrdiff_t>(image.step); };
  for (int candidate = first; candidate <= last; candidate += kBlockCandidates) {
    // The last ones overlap with those before, so as to stay inside the image.
    const int begin = std::max(kLeftReach, std::min(candidate, last + 1 - kBlockCandidates));
    const auto sums = block_differences(block(from, x, y), stride(from), block(to, begin, y), stride(to));
    const int end = std::min(last + 1, begin + kBlockCandidates);
    out = std::copy(sums.begin() + (candidate - begin), sums.begin() + (end - begin), out);
  }
}

// Index of the least cost; the first of equal ones.
std::size_t least_of(const std::uint16_t* costs, std::size_t count) {
  std::uint32_t least = std::numeric_limits<std::uint32_t>::max();  // cost, then index
  for (std::size_t i = 0; i < count; ++i) {
    least = std::min(least, static_cast<std::uint32_t>(costs[i]) << 16U | static_cast<std::uint32_t>(i));
  }
  return least & 0xffffU;
}

// The block of `from` at (x, y) searched in `to` over columns [first, last] of the same row.
RowMatch search_row(const cv::Mat& from, int x, int y, const cv::Mat& to, int first, int last) {
  thread_local Costs padded;
  compare_with_row(from, x, y, to, first, last, padded);
  const std::uint16_t* const costs = padded.data() + 1;
  const auto count = static_cast<std::ptrdiff_t>(padded.size()) - 2;
  if (count == 0) return {};
  const auto best = static_cast<std::ptrdiff_t>(least_of(costs, static_cast<std::size_t>(count)));
  RowMatch match;
  match.x = first + static_cast<int>(best);
  match.cost = cost_between_columns(costs + best);
  match.second_cost = std::min(least_between_columns(costs, costs + std::max(std::ptrdiff_t{0}, best - 1)),
                               least_between_columns(costs + std::min(count, best + 2), costs + count));
  return match;
}

GreyWindow window_of(const cv::Mat& level) {
  return {level.ptr<std::uint8_t>(), static_cast<std::ptrdiff_t>(level.step), level.cols, level.rows};
}

// Columns of the right (or left) octave that hold the whole block.
int clamp_column(const cv::Mat& level, int x) {
  return std::clamp(x, kLeftReach, level.cols - 1 - kRightReach);
}

// The right column of a left pixel, whole octave pixels, when the match is unique and mutual.
std::optional<int> search_right(const cv::Mat& left, const cv::Mat& right, int x, int y, int max_disparity,
                                const StereoOptions& options) {
  const RowMatch there = search_row(left, x, y, right, clamp_column(right, x - max_disparity), clamp_column(right, x));
  if (there.x < 0 || !there.is_unique(options.max_ratio)) return std::nullopt;
  const RowMatch back =
      search_row(right, there.x, y, left, clamp_column(left, there.x), clamp_column(left, there.x + max_disparity));
  if (std::abs(back.x - x) > 1) return std::nullopt;
  return there.x;
}

// The match of a left pixel to a right column, octave pixels.
struct OctaveMatch {
  float disparity = 0.0f;
  float sigma = 0.0f;
  float row_offset = 0.0f;
};

std::optional<OctaveMatch> refine_column(const cv::Mat& left, const cv::Mat& right, int x, int y, int right_x,
                                         const StereoOptions& options) {
  const Eigen::Vector2f pixel(static_cast<float>(x), static_cast<float>(y));
  CentredTemplate<kAlignSize> reference;
  if (!sample<kAlignSize>(window_of(left), pixel, reference.values)) return std::nullopt;
  reference.centre();
  AlignOptions align;
  align.max_shift = 2.0f;
  align.min_similarity = options.min_similarity;
  align.min_sigma = options.min_sigma;
  const auto aligned =
      align_window<kAlignSize>(reference, window_of(right), {static_cast<float>(right_x), pixel.y()}, align);
  if (!aligned || std::abs(aligned->pixel.y() - pixel.y()) > options.max_vertical_error) return std::nullopt;
  return OctaveMatch{pixel.x() - aligned->pixel.x(), aligned->sigma, aligned->pixel.y() - pixel.y()};
}

std::optional<StereoMatch> match_one(const cv::Mat& left, const cv::Mat& right, const Keypoint& keypoint,
                                     double max_disparity, const StereoOptions& options) {
  constexpr float kRoundingSigma = 0.29f;  // standard error of a value rounded to a whole pixel
  const float scale = kScaleOfOctave[keypoint.octave];
  const Eigen::Vector2f centre = octave_from_full(keypoint.pixel, keypoint.octave);
  const int x = static_cast<int>(std::lround(centre.x()));
  const int y = static_cast<int>(std::lround(centre.y()));
  if (left.cols < kBlockColumns + kBlockCandidates) return std::nullopt;
  if (y < kRowReach || y + kRowReach >= left.rows || x != clamp_column(left, x)) return std::nullopt;
  const auto right_x = search_right(left, right, x, y, static_cast<int>(max_disparity / scale) + 1, options);
  if (!right_x) return std::nullopt;
  const auto match = options.refine ? refine_column(left, right, x, y, *right_x, options)
                                    : OctaveMatch{static_cast<float>(x - *right_x), kRoundingSigma, 0.0f};
  if (!match || !(match->disparity > 0.0f)) return std::nullopt;
  return StereoMatch{match->disparity * scale, match->sigma * scale, match->row_offset * scale};
}

}  // namespace

std::vector<std::optional<StereoMatch>> match_stereo(const Pyramid& left, const Pyramid& right, const Rig& rig,
                                                     std::span<const Keypoint> keypoints,
                                                     const StereoOptions& options) {
  const double max_disparity =
      std::min(rig.focal * rig.baseline / options.min_depth, options.max_width_share * rig.width);
  std::vector<std::optional<StereoMatch>> matches;
  matches.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) {
    matches.push_back(
        match_one(left.levels[keypoint.octave], right.levels[keypoint.octave], keypoint, max_disparity, options));
  }
  return matches;
}

}  // namespace byre
