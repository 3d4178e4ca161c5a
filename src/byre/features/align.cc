#include "byre/features/align.h"

#include "byre/features/align_window.h"

namespace byre {
namespace {

constexpr int kTemplateSize = 8;

using Template = CentredTemplate<kTemplateSize>;

// Refills the template with the reference as it would look in the current view. False where it leaves the patch.
bool warp(const Patch& reference, const Eigen::Vector2f& reference_pixel, const Eigen::Matrix2f& reference_from_current,
          Template& warped) {
  constexpr float kHalf = 0.5f * (kTemplateSize - 1);
  // The warped square lies inside when its corners do. Each coordinate by itself: minCoeff() may pass over a NaN.
  const Eigen::Vector2f reach = reference_from_current.cwiseAbs() * Eigen::Vector2f::Constant(kHalf);
  const Eigen::Array2f low = reference_pixel - reach;
  const Eigen::Array2f high = reference_pixel + reach;
  constexpr float kSlack = 0.01f;  // allowance for the rounding of the walk along a row
  if (!((low >= kSlack).all() && (high <= Patch::kSize - 1 - kSlack).all())) return false;
  const Eigen::Vector2f along_row = reference_from_current.col(0);
  for (int y = 0; y < kTemplateSize; ++y) {
    Eigen::Vector2f at =
        reference_pixel + reference_from_current * Eigen::Vector2f(-kHalf, static_cast<float>(y) - kHalf);
    for (int x = 0; x < kTemplateSize; ++x, at += along_row) {
      const int column = static_cast<int>(at.x());
      const int row = static_cast<int>(at.y());
      const float fx = at.x() - static_cast<float>(column);
      const float fy = at.y() - static_cast<float>(row);
      const std::uint8_t* const p = reference.pixels.data() + row * Patch::kSize + column;
      const float upper = p[0] + fx * static_cast<float>(p[1] - p[0]);
      const float lower = p[Patch::kSize] + fx * static_cast<float>(p[Patch::kSize + 1] - p[Patch::kSize]);
      warped.values[static_cast<std::size_t>(y * kTemplateSize + x)] = upper + fy * (lower - upper);
    }
  }
  warped.centre();
  return true;
}

}  // namespace

std::optional<Alignment> align_patches(const Patch& reference, const Eigen::Vector2f& reference_pixel,
                                       const Patch& current, const Eigen::Matrix2f& reference_from_current,
                                       const Eigen::Vector2f& start, const AlignOptions& options) {
  Template warped;
  if (!warp(reference, reference_pixel, reference_from_current, warped)) return std::nullopt;
  const GreyWindow window{current.pixels.data(), Patch::kSize, Patch::kSize, Patch::kSize};
  return align_window<kTemplateSize>(warped, window, start, options);
}

}  // namespace byre
