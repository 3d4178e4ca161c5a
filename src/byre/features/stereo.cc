#include "byre/features/stereo.h"

#include "byre/base/scratch_memory.h"
#include "byre/features/align_window.h"
#include "byre/features/block_differences.h"
#include "byre/features/row_costs.h"

#include <algorithm>
#include <cassert>
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
  int cost = std::numeric_limits<int>::max();         // see find_minimum_cost
  int second_cost = std::numeric_limits<int>::max();  // the best more than one pixel away

  bool is_unique(float max_ratio) const {
    // One grey value per pixel: smaller differences do not distinguish candidates.
    constexpr int kAllowance = kBlockColumns * kBlockRows;
    return static_cast<float>(cost + kAllowance) < max_ratio * static_cast<float>(second_cost);
  }
};

// Costs of neighbouring columns, in the layout of find_minimum_cost.
using Costs = ScratchVector<std::uint16_t>;

// Costs of the block of `from` at (x, y) against those of `to` on columns [first, last] of the same row.
void compare_with_row(const cv::Mat& from, int x, int y, const cv::Mat& to, int first, int last, Costs& costs) {
  costs.resize(static_cast<std::size_t>(last - first + 3) + kCostPadding);
  costs.front() = 0;
  const auto stride = [](const cv::Mat& image) { return static_cast<std::ptrdiff_t>(image.step); };
  for (int candidate = first; candidate <= last; candidate += kBlockCandidates) {
    // The last candidates overlap with the previous ones, to stay inside the image.
    const int begin = std::max(kLeftReach, std::min(candidate, last + 1 - kBlockCandidates));
    const auto sums = block_differences(block(from, x, y), stride(from), block(to, begin, y), stride(to));
    // With few columns, some sums are before the first or after the last.
    const int skipped = std::max(0, first - begin);
    std::copy(sums.begin() + skipped, sums.end(), costs.begin() + 1 + (begin + skipped - first));
  }
}

// Searches the block of `from` at (x, y) in `to` over the columns [first, last] of the same row. padded: working
// memory.
RowMatch search_row(const cv::Mat& from, int x, int y, const cv::Mat& to, int first, int last, Costs& padded) {
  compare_with_row(from, x, y, to, first, last, padded);
  if (last < first) return {};
  const MinimumCost least = find_minimum_cost(padded.data() + 1, static_cast<std::size_t>(last - first + 1));
  RowMatch match;
  match.x = first + least.best;
  match.cost = least.cost;
  match.second_cost = least.second_cost;
  return match;
}

GreyWindow window_of(const cv::Mat& level) {
  return {level.ptr<std::uint8_t>(), static_cast<std::ptrdiff_t>(level.step), level.cols, level.rows};
}

// Clamps a column such that the whole block is inside the octave.
int clamp_column(const cv::Mat& level, int x) {
  return std::clamp(x, kLeftReach, level.cols - 1 - kRightReach);
}

// Right column of a left pixel, whole octave pixels, if the match is unique and mutual.
std::optional<int> search_right(const cv::Mat& left, const cv::Mat& right, int x, int y, int max_disparity,
                                const StereoOptions& options, Costs& costs) {
  const RowMatch there =
      search_row(left, x, y, right, clamp_column(right, x - max_disparity), clamp_column(right, x), costs);
  if (there.x < 0 || !there.is_unique(options.max_ratio)) return std::nullopt;
  const RowMatch back = search_row(right, there.x, y, left, clamp_column(left, there.x),
                                   clamp_column(left, there.x + max_disparity), costs);
  if (std::abs(back.x - x) > 1) return std::nullopt;
  return there.x;
}

// Match of a left pixel with a right column, in octave pixels.
std::optional<StereoMatch> refine_column(const cv::Mat& left, const cv::Mat& right, int x, int y, int right_x,
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
  return StereoMatch{pixel.x() - aligned->pixel.x(), aligned->sigma, aligned->pixel.y() - pixel.y()};
}

std::optional<StereoMatch> match_one(const cv::Mat& left, const cv::Mat& right, const Keypoint& keypoint,
                                     double max_disparity, const StereoOptions& options, Costs& costs) {
  const float scale = kScaleOfOctave[keypoint.octave];
  const Eigen::Vector2f centre = octave_from_full(keypoint.pixel, keypoint.octave);
  const int x = static_cast<int>(std::lround(centre.x()));
  const int y = static_cast<int>(std::lround(centre.y()));
  if (left.cols < kBlockColumns + kBlockCandidates) return std::nullopt;
  if (y < kRowReach || y + kRowReach >= left.rows || x != clamp_column(left, x)) return std::nullopt;
  const auto right_x = search_right(left, right, x, y, static_cast<int>(max_disparity / scale) + 1, options, costs);
  if (!right_x) return std::nullopt;
  const auto match = refine_column(left, right, x, y, *right_x, options);
  if (!match || !(match->disparity > 0.0f)) return std::nullopt;
  return StereoMatch{match->disparity * scale, match->sigma * scale, match->row_offset * scale};
}

}  // namespace

void match_stereo(const Pyramid& left, const Pyramid& right, const Rig& rig, std::span<const Keypoint> keypoints,
                  const StereoOptions& options, std::span<std::optional<StereoMatch>> matches) {
  assert(matches.size() == keypoints.size());
  const double max_disparity =
      std::min(rig.focal * rig.baseline / options.min_depth, options.max_width_share * rig.width);
  Costs costs;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const std::size_t octave = keypoints[i].octave;
    matches[i] = match_one(left.levels[octave], right.levels[octave], keypoints[i], max_disparity, options, costs);
  }
}

}  // namespace byre
