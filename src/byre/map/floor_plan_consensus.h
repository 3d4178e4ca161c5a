#pragma once

#include "byre/alignment.h"

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// A place seen from above in two frames, x and y as the real and the imaginary part.
struct PlanarPair {
  std::complex<double> in_source;
  std::complex<double> in_target;
  double sigma = 1.0;  // standard error of each coordinate in the target
};

// in_target = turn * in_source + shift: the turn's angle is the rotation, its magnitude the scale.
struct PlanarSimilarity {
  std::complex<double> turn = 1.0;
  std::complex<double> shift = 0.0;
};

// Pairs that agree on one similarity, or rigid motion, of the plane.
struct PlanarConsensus {
  PlanarSimilarity target_from_source;  // least squares over the inliers
  std::vector<bool> is_inlier;          // one for each pair
};

// How far apart pairs may be that agree, in sigmas as given, from all their residuals, so counted: 99 % of what is
// normally distributed. More than three when more than a few residuals are larger than their sigmas explain.
double largest_agreeing_residual(std::vector<double> residuals);

// Least trimmed squares: of the motions that two pairs determine, all of them tried, that whose nearest half of the
// pairs fits best, improved by refitting that half (Rousseeuw and Van Driessen 2006, theorem 1). Empty when no two
// pairs lie apart in both frames.
std::optional<PlanarConsensus> find_planar_consensus(std::span<const PlanarPair> pairs, Scale scale);

}  // namespace byre
