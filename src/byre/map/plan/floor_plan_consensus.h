#pragma once

#include "byre/alignment.h"

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// A position seen from above in two frames, x and y as real and imaginary part.
struct PlanarPair {
  std::complex<double> in_source;
  std::complex<double> in_target;
  double sigma = 1.0;  // standard error per axis, in the target
};

// in_target = turn * in_source + shift. The argument of turn is the rotation, its magnitude the scale.
struct PlanarSimilarity {
  std::complex<double> turn = 1.0;
  std::complex<double> shift = 0.0;
};

// Pairs consistent with one planar similarity or rigid motion.
struct PlanarConsensus {
  PlanarSimilarity target_from_source;  // least squares over the inliers
  std::vector<bool> is_inlier;          // one per pair
};

// Bound of inlier residuals, in the given sigmas: the 99 % quantile for normally distributed errors. More than three
// sigmas if more than a few residuals exceed their sigmas.
double largest_agreeing_residual(std::vector<double> residuals);

// Least trimmed squares: of the motions determined by two pairs, the one that best fits its nearest half of the pairs,
// improved by refits to that half (Rousseeuw and Van Driessen 2006, theorem 1). Empty if no two pairs are separate in
// both frames.
std::optional<PlanarConsensus> find_planar_consensus(std::span<const PlanarPair> pairs, Scale scale);

}  // namespace byre
