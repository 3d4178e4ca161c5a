#include "byre/map/plan/planar_consensus.h"

#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace byre {
namespace {

using Complex = PlanarPoint;
using Pairs = std::span<const PlanarPair>;
using Subset = std::vector<std::size_t>;  // indices of pairs

constexpr double kRayleighMedian = 1.1774;  // median length of a vector of two standard normal variables
constexpr double kRayleigh99 = 3.0349;      // 99 % quantile of that length
constexpr std::size_t kMostSubsets = 20000;
constexpr int kMostSteps = 20;

// Least squares weighted by 1/sigma^2; Umeyama's solution in the plane. Empty if all pairs coincide in one frame.
std::optional<PlanarSimilarity> fit(Pairs pairs, const Subset& subset, Scale scale) {
  Complex source_sum = 0.0, target_sum = 0.0;
  double weights = 0.0;
  for (const std::size_t i : subset) {
    const double weight = 1.0 / (pairs[i].sigma * pairs[i].sigma);
    source_sum += weight * pairs[i].in_source;
    target_sum += weight * pairs[i].in_target;
    weights += weight;
  }
  const Complex source_mean = source_sum / weights, target_mean = target_sum / weights;
  Complex product = 0.0;
  double source_variance = 0.0;
  for (const std::size_t i : subset) {
    const double weight = 1.0 / (pairs[i].sigma * pairs[i].sigma);
    const Complex source = pairs[i].in_source - source_mean;
    product += weight * (pairs[i].in_target - target_mean) * std::conj(source);
    source_variance += weight * std::norm(source);
  }
  const double length = scale == Scale::free ? source_variance : std::abs(product);
  if (!(std::abs(product) > 0.0) || !(length > 0.0)) return std::nullopt;
  const Complex turn = product / length;
  return PlanarSimilarity{turn, target_mean - turn * source_mean};
}

// Lengths, in sigmas.
std::vector<double> residuals_of(Pairs pairs, const PlanarSimilarity& motion) {
  std::vector<double> residuals;
  for (const PlanarPair& pair : pairs) {
    residuals.push_back(std::abs(motion.turn * pair.in_source + motion.shift - pair.in_target) / pair.sigma);
  }
  return residuals;
}

// Size of the half of `count` pairs, two of which determine a motion. In a larger subset outliers might be a majority.
std::size_t trusted_half(std::size_t count) {
  return std::min((count + 3) / 2, count);
}

struct TrimmedFit {
  PlanarSimilarity motion;
  Subset nearest;  // indices of the half with the best fit, ascending
  double cost = std::numeric_limits<double>::infinity();
};

TrimmedFit trim(Pairs pairs, const PlanarSimilarity& motion) {
  const std::vector<double> residuals = residuals_of(pairs, motion);
  TrimmedFit trimmed{motion, Subset(pairs.size()), 0.0};
  std::iota(trimmed.nearest.begin(), trimmed.nearest.end(), std::size_t{0});
  std::ranges::stable_sort(trimmed.nearest, {}, [&residuals](std::size_t i) { return residuals[i]; });
  trimmed.nearest.resize(trusted_half(pairs.size()));
  std::ranges::sort(trimmed.nearest);
  for (const std::size_t i : trimmed.nearest) trimmed.cost += residuals[i] * residuals[i];
  return trimmed;
}

// The best motion determined by two pairs. With very many pairs only some of the sets are tried.
std::optional<TrimmedFit> best_of_twos(Pairs pairs, Scale scale) {
  const std::size_t stride = 1 + pairs.size() * pairs.size() / 2 / kMostSubsets;
  std::optional<TrimmedFit> best;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      if (count++ % stride != 0) continue;
      const std::optional<PlanarSimilarity> motion = fit(pairs, {i, j}, scale);
      if (!motion) continue;
      TrimmedFit trimmed = trim(pairs, *motion);
      if (!best || trimmed.cost < best->cost) best = std::move(trimmed);
    }
  }
  return best;
}

TrimmedFit concentrate(Pairs pairs, TrimmedFit best, Scale scale) {
  for (int step = 0; step < kMostSteps; ++step) {
    const std::optional<PlanarSimilarity> motion = fit(pairs, best.nearest, scale);
    if (!motion) break;
    TrimmedFit better = trim(pairs, *motion);
    if (!(better.cost < best.cost)) break;
    best = std::move(better);
  }
  return best;
}

// Points at which the line of a wall and another line cross, as a share of the way from start to end. Empty below 20
// degrees.
std::optional<Complex> crossing(const Complex& start, const Complex& end, const Complex& other_start,
                                const Complex& other_direction) {
  constexpr double kLeastSine = 0.34;
  const Complex along = end - start;
  const double sine = std::imag(std::conj(along) * other_direction);
  if (!(std::abs(sine) > kLeastSine * std::abs(along) * std::abs(other_direction))) return std::nullopt;
  return start + along * (std::imag(std::conj(other_start - start) * other_direction) / sine);
}

}  // namespace

double largest_agreeing_residual(std::vector<double> residuals) {
  const auto count = static_cast<double>(residuals.size());
  // Finite-sample correction for the exact fit to two pairs, which lowers the residuals (Rousseeuw and Leroy 1987).
  const double few = count > 2.0 ? 1.0 + 5.0 / (count - 2.0) : 1.0;
  return kRayleigh99 * std::max(1.0, few * median(std::move(residuals)) / kRayleighMedian);
}

std::optional<PlanarSimilarity> find_planar_consensus(Pairs pairs, Scale scale) {
  const std::optional<TrimmedFit> start = best_of_twos(pairs, scale);
  if (!start) return std::nullopt;
  const TrimmedFit trimmed = concentrate(pairs, *start, scale);
  const std::vector<double> residuals = residuals_of(pairs, trimmed.motion);
  const double limit = largest_agreeing_residual(residuals);
  Subset inliers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (residuals[i] <= limit) inliers.push_back(i);
  }
  const std::optional<PlanarSimilarity> refined = fit(pairs, inliers, scale);
  return refined ? refined : trimmed.motion;
}

std::vector<PlanarPair> pairs_of_walls(std::span<const PlanarPair> points, std::span<const PlanarWall> walls) {
  std::vector<PlanarPair> pairs;
  const auto add = [&pairs](const PlanarWall& wall, const PlanarPair& other, const Complex& direction_in_source,
                            const Complex& direction_in_target) {
    const auto source = crossing(wall.start.in_source, wall.end.in_source, other.in_source, direction_in_source);
    const auto target = crossing(wall.start.in_target, wall.end.in_target, other.in_target, direction_in_target);
    if (source && target) pairs.push_back({*source, *target, std::hypot(wall.start.sigma, other.sigma)});
  };
  constexpr Complex kQuarterTurn(0.0, 1.0);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const PlanarWall& wall = walls[i];
    for (std::size_t j = i + 1; j < walls.size(); ++j) {
      const auto& [start, end] = walls[j];
      add(wall, start, end.in_source - start.in_source, end.in_target - start.in_target);
    }
    for (const PlanarPair& point : points) {
      add(wall, point, kQuarterTurn * (wall.end.in_source - wall.start.in_source),
          kQuarterTurn * (wall.end.in_target - wall.start.in_target));
    }
  }
  return pairs;
}

}  // namespace byre
