#pragma once

#include "byre/alignment.h"

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Position seen from above, x and y as real and imaginary part.
using PlanarPoint = std::complex<double>;

// A position in two frames.
struct PlanarPair {
  PlanarPoint in_source;
  PlanarPoint in_target;
  double sigma = 1.0;  // standard error per axis, in the target
};

// A wall seen from above: start and end of its line in both frames.
struct PlanarWall {
  PlanarPair start;
  PlanarPair end;
};

// in_target = turn * in_source + shift. The argument of turn is the rotation, its magnitude the scale.
struct PlanarSimilarity {
  PlanarPoint turn = 1.0;
  PlanarPoint shift = 0.0;
};

// Bound of inlier residuals, in the given sigmas: the 99 % quantile for normally distributed errors. More than three
// sigmas if more than a few residuals exceed their sigmas.
double largest_agreeing_residual(std::vector<double> residuals);

// Least trimmed squares: of the motions determined by two pairs, the one that best fits its nearest half of the pairs,
// improved by refits to that half (Rousseeuw and Van Driessen 2006, theorem 1), then least squares over its inliers.
// Empty if no two pairs are separate in both frames.
std::optional<PlanarSimilarity> find_planar_consensus(std::span<const PlanarPair> pairs, Scale scale);

// Pairs by the geometry of walls: their corners, and the foot of the perpendicular from a point to a wall.
std::vector<PlanarPair> pairs_of_walls(std::span<const PlanarPair> points, std::span<const PlanarWall> walls);

}  // namespace byre
