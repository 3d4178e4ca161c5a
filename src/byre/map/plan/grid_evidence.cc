#include "byre/map/plan/grid_evidence.h"

#include "byre/map/plan/path_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/LU>

namespace byre {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Evidence of a cell in units of 1/32 log-odds, in one byte because grids have many cells.
constexpr double kUnit = 32.0;
constexpr std::int8_t kNoEvidence = -128;
// Values of OctoMap (Hornung et al. 2013, section 5).
constexpr double kHit = 0.85, kMiss = -0.4;
constexpr double kLeast = -2.0, kMost = 3.5;
constexpr double kOccupied = 0.62, kFree = -0.62;  // probabilities 0.65 and 0.35

constexpr double kSigmas = 3.0;         // distance from a point that its ray does not free
constexpr double kThickestLayer = 0.1;  // metres, up to kMostLayers
constexpr int kMostLayers = 50;

using CellIndex = std::uint32_t;

struct Hit {
  CellIndex cell = 0;
  double probability = 0.0;
};

// Two points on a line, with points enough between and beyond them.
struct Link {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  auto operator<=>(const Link&) const = default;
};

class Cells {
 public:
  explicit Cells(const FloorPlan& grid) : grid_(grid), pixel_per_metre_(1.0 / grid.metres_per_pixel(0, 0)) {}

  std::size_t count() const { return static_cast<std::size_t>(grid_.width) * static_cast<std::size_t>(grid_.height); }
  double resolution() const { return grid_.metres_per_pixel(0, 0); }

  // Position in units of cells; whole numbers are the corners of cells.
  Vector2d place(const Vector2d& point) const {
    const Vector2d offset = pixel_per_metre_ * (point - grid_.top_left_in_plan);
    return {offset.x() + 0.5, 0.5 - offset.y()};
  }
  bool is_inside(int column, int row) const {
    return column >= 0 && row >= 0 && column < grid_.width && row < grid_.height;
  }
  CellIndex index(int column, int row) const {
    return static_cast<CellIndex>(row) * static_cast<CellIndex>(grid_.width) + static_cast<CellIndex>(column);
  }

  // Cells along a line (Amanatides and Woo 1987).
  template <typename Visit>
  void visit_line(const Vector2d& from_point, const Vector2d& to_point, const Visit& visit) const {
    const Vector2d from = place(from_point), to = place(to_point), step = to - from;
    double begin = 0.0, end = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
      const double limit = axis == 0 ? grid_.width : grid_.height;
      if (step[axis] == 0.0) {
        if (from[axis] < 0.0 || from[axis] >= limit) return;
        continue;
      }
      const double first = (0.0 - from[axis]) / step[axis], last = (limit - from[axis]) / step[axis];
      begin = std::max(begin, std::min(first, last));
      end = std::min(end, std::max(first, last));
    }
    if (begin > end) return;
    std::array<int, 2> cell{}, direction{};
    std::array<double, 2> next{}, across{};
    const Vector2d start = from + begin * step;
    const std::array<int, 2> size = {grid_.width, grid_.height};
    for (int axis = 0; axis < 2; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      cell[i] = std::clamp(static_cast<int>(std::floor(start[axis])), 0, size[i] - 1);
      direction[i] = step[axis] > 0.0 ? 1 : -1;
      const bool moves = step[axis] != 0.0;
      across[i] = moves ? std::abs(1.0 / step[axis]) : std::numeric_limits<double>::infinity();
      const double border = cell[i] + (step[axis] > 0.0 ? 1 : 0);
      next[i] = moves ? (border - from[axis]) / step[axis] : std::numeric_limits<double>::infinity();
    }
    while (is_inside(cell[0], cell[1])) {
      visit(index(cell[0], cell[1]));
      const std::size_t axis = next[0] < next[1] ? 0 : 1;
      if (next[axis] > end) return;
      cell[axis] += direction[axis];
      next[axis] += across[axis];
    }
  }

 private:
  const FloorPlan& grid_;
  double pixel_per_metre_;
};

// Probabilities that the point is in the cells around it; they add up to 1. A cell adds the variance of its width.
std::vector<Hit> spread(const GridPoint& point, const Cells& cells) {
  const double rounding = cells.resolution() * cells.resolution() / 12.0;
  const Eigen::Matrix2d covariance = point.covariance.topLeftCorner<2, 2>() + rounding * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d information = covariance.inverse() * cells.resolution() * cells.resolution();
  const Vector2d place = cells.place(point.position.head<2>());
  const Vector2d reach = kSigmas / cells.resolution() * covariance.diagonal().cwiseSqrt();
  std::vector<Hit> hits;
  double sum = 0.0;
  for (int row = static_cast<int>(std::floor(place.y() - reach.y())); row <= place.y() + reach.y(); ++row) {
    for (int column = static_cast<int>(std::floor(place.x() - reach.x())); column <= place.x() + reach.x(); ++column) {
      if (!cells.is_inside(column, row)) continue;
      Vector2d offset = Vector2d(column + 0.5, row + 0.5) - place;
      offset.y() = -offset.y();  // rows go down
      const double squared = offset.dot(information * offset);
      if (squared > kSigmas * kSigmas) continue;
      hits.push_back({cells.index(column, row), std::exp(-0.5 * squared)});
      sum += hits.back().probability;
    }
  }
  for (Hit& hit : hits) hit.probability /= sum;
  return hits;
}

// Points seen from above, for the search of lines.
class Lines {
 public:
  Lines(std::span<const GridPoint> points, double gap, double width)
      : points_(points), gap_(gap), width_(width), cells_(places_of(points, numbers_), 1.5 * gap) {}

  // Joins each point to the nearest one in each direction if the points around support the line.
  std::vector<Link> find() const {
    constexpr int kDirections = 12;
    std::vector<Link> links;
    for (const std::uint32_t from : numbers_) {
      const std::vector<std::uint32_t> near = cells_.near(flat(from));
      std::array<std::pair<double, std::uint32_t>, kDirections> nearest;
      nearest.fill({gap_, from});
      for (const std::uint32_t i : near) {
        const std::uint32_t to = numbers_[i];
        const Vector2d step = place(to) - place(from);
        const double length = step.norm();
        if (length < width_) continue;
        const double turn = std::atan2(step.y(), step.x()) / (2.0 * std::numbers::pi) + 0.5;
        auto& best = nearest[static_cast<std::size_t>(std::min(turn * kDirections, kDirections - 1.0))];
        if (length < best.first) best = {length, to};
      }
      for (const auto& [length, to] : nearest) {
        if (to != from && is_supported(from, to, near)) links.push_back({std::min(from, to), std::max(from, to)});
      }
    }
    std::ranges::sort(links);
    links.erase(std::unique(links.begin(), links.end()), links.end());
    return links;
  }

 private:
  static std::vector<Vector3d> places_of(std::span<const GridPoint> points, std::vector<std::uint32_t>& numbers) {
    std::vector<Vector3d> places;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (!points[i].is_obstacle) continue;
      numbers.push_back(i);
      places.emplace_back(points[i].position.x(), points[i].position.y(), 0.0);
    }
    return places;
  }

  Vector2d place(std::uint32_t point) const { return points_[point].position.head<2>(); }
  Vector3d flat(std::uint32_t point) const { return {place(point).x(), place(point).y(), 0.0}; }

  // Whether more points are on the line than on each of two parallel strips beside it.
  bool is_supported(std::uint32_t from, std::uint32_t to, const std::vector<std::uint32_t>& near) const {
    constexpr int kFewest = 6;  // points, these two included
    constexpr int kFactor = 2;
    const Vector2d middle = 0.5 * (place(from) + place(to));
    const Vector2d along = (place(to) - place(from)).normalized(), across(-along.y(), along.x());
    std::array<int, 3> counts{};  // right, on the line, left
    for (const std::uint32_t i : near) {
      const Vector2d offset = place(numbers_[i]) - middle;
      const double strip = std::floor(across.dot(offset) / (2.0 * width_) + 0.5) + 1.0;
      if (std::abs(along.dot(offset)) > gap_ || strip < 0.0 || strip > 2.0) continue;
      ++counts[static_cast<std::size_t>(strip)];
    }
    return counts[1] >= kFewest && counts[1] >= kFactor * std::max(counts[0], counts[2]);
  }

  std::span<const GridPoint> points_;
  double gap_;                          // longest link, metres
  double width_;                        // half of a strip's width, metres
  std::vector<std::uint32_t> numbers_;  // indices of the obstacles
  PathCells cells_;                     // positions of the obstacles, heights zero
};

// Part of a segment between two heights, as fractions of its length.
std::optional<std::pair<double, double>> part_between(double from, double to, double low, double high) {
  const double rise = to - from;
  if (std::abs(rise) < 1e-9) return from >= low && from < high ? std::optional(std::pair(0.0, 1.0)) : std::nullopt;
  const double at_low = (low - from) / rise, at_high = (high - from) / rise;
  const double begin = std::max(0.0, std::min(at_low, at_high)), end = std::min(1.0, std::max(at_low, at_high));
  return begin < end ? std::optional(std::pair(begin, end)) : std::nullopt;
}

// Observations of one camera.
struct Scan {
  std::vector<std::uint32_t> points;
  std::vector<std::uint32_t> links;
};

class LayerEvidence {
 public:
  LayerEvidence(const Cells& cells, double low, double high)
      : cells_(cells), low_(low), high_(high), evidence_(cells.count(), kNoEvidence) {}

  void add_hits(double height, const std::vector<Hit>& hits) {
    if (height >= low_ && height < high_) hits_.insert(hits_.end(), hits.begin(), hits.end());
  }

  void add_link(const Vector3d& from, const Vector3d& to) {
    visit(from, to, [this](CellIndex cell) { hits_.push_back({cell, 1.0}); });
  }

  void add_ray(const Vector3d& camera, const GridPoint& point) {
    const Vector3d ray = point.position - camera;
    const double range = ray.norm();
    const double sigma = std::sqrt(std::max(0.0, ray.dot(point.covariance * ray))) / std::max(range, 1e-9);
    const double length = range - kSigmas * sigma - cells_.resolution();
    if (length <= 0.0) return;
    visit(camera, camera + length / range * ray, [this](CellIndex cell) { missed_.push_back(cell); });
  }

  // Ends a scan. Each cell changes once, by the expected log-odds.
  void update() {
    std::ranges::sort(missed_);
    missed_.erase(std::unique(missed_.begin(), missed_.end()), missed_.end());
    std::ranges::sort(hits_, {}, &Hit::cell);
    auto missed = missed_.begin();
    for (auto hit = hits_.begin(); hit != hits_.end();) {
      const CellIndex cell = hit->cell;
      double no_hit = 1.0;
      for (; hit != hits_.end() && hit->cell == cell; ++hit) no_hit *= 1.0 - hit->probability;
      for (; missed != missed_.end() && *missed < cell; ++missed) change(*missed, kMiss);
      const bool is_missed = missed != missed_.end() && *missed == cell;
      if (is_missed) ++missed;
      change(cell, (1.0 - no_hit) * kHit + (is_missed ? no_hit * kMiss : 0.0));
    }
    for (; missed != missed_.end(); ++missed) change(*missed, kMiss);
    missed_.clear();
    hits_.clear();
  }

  void project(std::vector<std::int8_t>& occupancy) const {
    for (std::size_t i = 0; i < evidence_.size(); ++i) {
      if (evidence_[i] == kNoEvidence) continue;
      if (evidence_[i] > kUnit * kOccupied) occupancy[i] = kOccupiedPixel;
      if (evidence_[i] < kUnit * kFree && occupancy[i] == kUnknownPixel) occupancy[i] = kFreePixel;
    }
  }

 private:
  template <typename Visit>
  void visit(const Vector3d& from, const Vector3d& to, const Visit& visit_cell) const {
    const auto part = part_between(from.z(), to.z(), low_, high_);
    if (!part) return;
    const Vector2d begin = from.head<2>(), step = (to - from).head<2>();
    cells_.visit_line(begin + part->first * step, begin + part->second * step, visit_cell);
  }

  void change(CellIndex cell, double log_odds) {
    std::int8_t& evidence = evidence_[cell];
    const double before = evidence == kNoEvidence ? 0.0 : evidence;
    evidence =
        static_cast<std::int8_t>(std::lround(std::clamp(before + kUnit * log_odds, kUnit * kLeast, kUnit * kMost)));
  }

  const Cells& cells_;
  double low_, high_;
  std::vector<std::int8_t> evidence_;
  std::vector<Hit> hits_;  // hits and misses of the present scan
  std::vector<CellIndex> missed_;
};

std::vector<Scan> scans_of(std::span<const GridPoint> points, const std::vector<Link>& links, std::size_t count) {
  std::vector<Scan> scans(count);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (const std::uint32_t scan : points[i].scans) scans[scan].points.push_back(i);
  }
  for (std::uint32_t i = 0; i < links.size(); ++i) {
    const auto& from = points[links[i].from].scans;
    const auto& to = points[links[i].to].scans;
    std::vector<std::uint32_t> both;
    std::ranges::set_intersection(from, to, std::back_inserter(both));
    for (const std::uint32_t scan : both) scans[scan].links.push_back(i);
  }
  return scans;
}

}  // namespace

std::vector<std::int8_t> occupancy_by_rays(const FloorPlan& grid, std::span<const GridPoint> points,
                                           std::span<const Vector3d> cameras, const GridLayers& layers) {
  const Cells cells(grid);
  std::vector<Link> links;
  if (layers.largest_gap > 0.0) links = Lines(points, layers.largest_gap, cells.resolution()).find();
  const std::vector<Scan> scans = scans_of(points, links, cameras.size());
  std::vector<std::vector<Hit>> spreads(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].is_obstacle) spreads[i] = spread(points[i], cells);
  }
  std::vector<std::int8_t> occupancy(cells.count(), kUnknownPixel);
  const double whole = std::ceil((layers.high - layers.low) / kThickestLayer);
  const int count = static_cast<int>(std::clamp(whole, 1.0, static_cast<double>(kMostLayers)));
  const double thickness = (layers.high - layers.low) / count;
  for (int layer = 0; layer < count; ++layer) {
    const double low = layers.low + layer * thickness;
    LayerEvidence evidence(cells, low, low + thickness);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      for (const std::uint32_t point : scans[i].points) {
        evidence.add_ray(cameras[i], points[point]);
        if (points[point].is_obstacle) evidence.add_hits(points[point].position.z(), spreads[point]);
      }
      for (const std::uint32_t link : scans[i].links) {
        evidence.add_link(points[links[link].from].position, points[links[link].to].position);
      }
      evidence.update();
    }
    evidence.project(occupancy);
  }
  return occupancy;
}

}  // namespace byre
