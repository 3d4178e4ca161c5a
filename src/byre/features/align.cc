#include "byre/features/align.h"

#include "byre/features/align_sums.h"
#include "byre/features/align_window.h"

namespace byre {
namespace {

constexpr int kTemplateSize = 8;  // required by warp_square

using Template = CentredTemplate<kTemplateSize>;

// Refills the template with the reference warped to the current view. False if it leaves the patch.
bool warp(const Patch& reference, const Eigen::Vector2f& reference_pixel, const Eigen::Matrix2f& reference_from_current,
          Template& warped) {
  constexpr float kHalf = 0.5f * (kTemplateSize - 1);
  // The warped square is inside if its corners are. Tests each coordinate, because minCoeff() may ignore a NaN.
  const Eigen::Vector2f reach = reference_from_current.cwiseAbs() * Eigen::Vector2f::Constant(kHalf);
  const Eigen::Array2f low = reference_pixel - reach;
  const Eigen::Array2f high = reference_pixel + reach;
  constexpr float kSlack = 0.01f;  // tolerance for rounded positions
  if (!((low >= kSlack).all() && (high <= Patch::kSize - 1 - kSlack).all())) return false;
  const Eigen::Vector2f along_row = reference_from_current.col(0), along_column = reference_from_current.col(1);
  const Eigen::Vector2f first = reference_pixel - kHalf * (along_row + along_column);
  warp_square(reference.pixels.data(),
              {first.x(), first.y(), along_row.x(), along_row.y(), along_column.x(), along_column.y()},
              warped.values.data());
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
