#include "byre/map/plan/plan_matching.h"

#include "byre/base/enum_names.h"
#include "byre/geometry/degrees.h"
#include "byre/map/plan/wall_distances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace byre {
namespace {

using Eigen::Vector2d;

constexpr double kCell = 0.1;      // metres, of the map's occupancy grid
constexpr double kBlock = 0.5;     // metres, edge of a square whose cells are correlated
constexpr double kDistinct = 0.5;  // metres between distinct poses
constexpr double kDistinctTurn = 5.0 * kDegree;
constexpr double kOnWall = 0.2;  // metres, largest distance of an obstacle that is on a wall
constexpr double kLeastExplained = 0.5;
constexpr double kMostDrivenWalls = 0.05;  // share of the path that is on walls

// Position and heading on the plan, relative to its corner, of the middle of the path.
struct PlanarPose {
  Vector2d position = Vector2d::Zero();
  double yaw = 0.0;
};

enum class CellKind : std::uint8_t { obstacle, free, driven };

// Cell of the map, relative to the middle of the path.
struct MapCell {
  Vector2d position;
  CellKind kind = CellKind::free;
  int block = 0;
};

constexpr double kNotDrawn = 0.1;  // share of obstacles that the plan does not have

// Log-likelihood of a cell by the distance of the nearest wall. sigma: of obstacles, metres.
double log_likelihood(CellKind kind, double distance, double sigma, double cell) {
  if (kind == CellKind::obstacle) {
    return std::log(kNotDrawn + (1.0 - kNotDrawn) * std::exp(-0.5 * distance * distance / (sigma * sigma)));
  }
  const double on_wall = std::max(0.0, 1.0 - distance / cell);
  return (kind == CellKind::driven ? -4.0 : -0.7) * on_wall;
}

// Cells of the map, thinned to a number that can be compared.
std::vector<MapCell> cells_of(const OccupancyGrid& grid, const std::vector<Vector2d>& path, const Vector2d& middle) {
  std::vector<MapCell> cells;
  std::map<std::pair<int, int>, int> blocks;
  const auto add = [&](const Vector2d& position, CellKind kind) {
    const std::pair block(static_cast<int>(std::floor(position.x() / kBlock)),
                          static_cast<int>(std::floor(position.y() / kBlock)));
    const int number = blocks.try_emplace(block, static_cast<int>(blocks.size())).first->second;
    cells.push_back({position - middle, kind, number});
  };
  for (int row = 0; row < grid.plan.height; ++row) {
    for (int column = 0; column < grid.plan.width; ++column) {
      const std::int8_t value = grid.occupancy[static_cast<std::size_t>(row) * grid.plan.width + column];
      if (value == kOccupiedPixel) add(grid.plan.point_at({column, row}), CellKind::obstacle);
      if (value == kFreePixel && row % 3 == 0 && column % 3 == 0) {
        add(grid.plan.point_at({column, row}), CellKind::free);
      }
    }
  }
  for (const Vector2d& position : path) add(position, CellKind::driven);
  return cells;
}

// Positions along the path at most 0.1 m apart, in the grid's frame.
std::vector<Vector2d> dense_path(const MapGraph& map, const Similarity& ground_from_map) {
  constexpr double kStep = 0.1;
  constexpr double kLongest = 1.0;  // between keyframes with a straight path
  std::vector<Vector2d> path;
  std::optional<Vector2d> last;
  int recording = -1;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    const Vector2d next = (ground_from_map * body_at(map, keyframe)).head<2>();
    if (last && keyframe.recording == recording && (next - *last).norm() < kLongest) {
      const int steps = static_cast<int>((next - *last).norm() / kStep);
      for (int i = 1; i <= steps; ++i) path.emplace_back(*last + (next - *last) * i / (steps + 1));
    }
    path.push_back(next);
    last = next;
    recording = keyframe.recording;
  }
  return path;
}

class PlanMatcher {
 public:
  PlanMatcher(const WallDistances& walls, std::vector<MapCell> cells) : walls_(walls), cells_(std::move(cells)) {
    for (const MapCell& cell : cells_) blocks_ = std::max(blocks_, cell.block + 1);
    for (const CellKind kind : {CellKind::obstacle, CellKind::free, CellKind::driven}) {
      for (const float distance : walls.distances()) {
        values_[static_cast<std::size_t>(kind)].push_back(
            static_cast<float>(log_likelihood(kind, distance, kSigma, kCell)));
      }
    }
  }

  double score(const PlanarPose& pose) const {
    double sum = 0.0;
    visit(pose, [&sum](const MapCell&, double value) { sum += value; });
    return sum;
  }

  std::vector<double> block_scores(const PlanarPose& pose) const {
    std::vector<double> scores(static_cast<std::size_t>(blocks_), 0.0);
    visit(pose,
          [&scores](const MapCell& cell, double value) { scores[static_cast<std::size_t>(cell.block)] += value; });
    return scores;
  }

  // Local maxima of the likelihood on a coarse grid of poses, refined; the best first.
  std::vector<PlanarPose> search() const;

  // Ascends to a local maximum by steps along x, y and yaw that shrink.
  PlanarPose refined(PlanarPose pose) const {
    double best = score(pose);
    for (double step = 0.16; step > 0.008; step *= 0.5) {
      for (int tries = 0; tries < 8; ++tries) {
        bool is_better = false;
        for (const auto& [x, y, turn] : kDirections) {
          const PlanarPose next{pose.position + step * Vector2d(x, y), pose.yaw + 8.0 * kDegree * step * turn};
          const double at_next = score(next);
          if (!(at_next > best)) continue;
          best = at_next;
          pose = next;
          is_better = true;
        }
        if (!is_better) break;
      }
    }
    return pose;
  }

  const std::vector<MapCell>& cells() const { return cells_; }

 private:
  static constexpr double kSigma = 0.1;
  static constexpr std::array<std::array<int, 3>, 6> kDirections = {
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

  template <typename Visit>
  void visit(const PlanarPose& pose, const Visit& visit) const {
    const Eigen::Rotation2Dd turn(pose.yaw);
    for (const MapCell& cell : cells_) {
      const std::size_t index = walls_.index_at(pose.position + turn * cell.position);
      visit(cell, values_[static_cast<std::size_t>(cell.kind)][index]);
    }
  }

  const WallDistances& walls_;
  std::vector<MapCell> cells_;
  std::array<std::vector<float>, 3> values_;  // log-likelihoods of each kind, of the cells of walls_
  int blocks_ = 0;
};

bool is_distinct(const PlanarPose& a, const PlanarPose& b) {
  return (a.position - b.position).norm() > kDistinct ||
         std::abs(std::remainder(a.yaw - b.yaw, 2.0 * std::numbers::pi)) > kDistinctTurn;
}

// Log-likelihoods of all positions on a coarse grid, at one heading after another.
class CoarseSearch {
 public:
  static constexpr double kStep = 0.25;  // metres

  CoarseSearch(const WallDistances& walls, const std::vector<MapCell>& cells)
      : columns_(static_cast<int>(walls.size().x() / kStep) + 1),
        rows_(static_cast<int>(walls.size().y() / kStep) + 1),
        scores_(static_cast<std::size_t>(columns_) * rows_) {
    constexpr double kCoarseSigma = 0.3;     // metres
    constexpr std::size_t kMostCells = 400;  // limit for each kind
    for (const CellKind kind : {CellKind::obstacle, CellKind::free, CellKind::driven}) {
      CellsOfKind of_kind;
      const auto value = [kind](double distance) {
        return static_cast<float>(log_likelihood(kind, distance, kCoarseSigma, kCell));
      };
      of_kind.outside = value(WallDistances::kReach);
      for (int row = 0; row < rows_; ++row) {
        for (int column = 0; column < columns_; ++column) {
          of_kind.values.push_back(value(walls.at(kStep * Vector2d(column, row))));
        }
      }
      std::vector<Vector2d> all;
      for (const MapCell& cell : cells) {
        if (cell.kind == kind) all.push_back(cell.position);
      }
      const std::size_t stride = 1 + all.size() / kMostCells;
      for (std::size_t i = 0; i < all.size(); i += stride) of_kind.positions.push_back(all[i]);
      kinds_.push_back(std::move(of_kind));
    }
  }

  // Adds the local maxima of the positions at a heading.
  void add_peaks(double yaw, std::vector<std::pair<float, PlanarPose>>& peaks) {
    std::ranges::fill(scores_, 0.0F);
    for (const CellsOfKind& kind : kinds_) {
      for (const Vector2d& position : kind.positions) add_cell(kind, Eigen::Rotation2Dd(yaw) * position / kStep);
    }
    for (int row = 1; row + 1 < rows_; ++row) {
      for (int column = 1; column + 1 < columns_; ++column) {
        if (is_peak(row, column)) peaks.emplace_back(at(row, column), PlanarPose{kStep * Vector2d(column, row), yaw});
      }
    }
  }

 private:
  struct CellsOfKind {
    std::vector<Vector2d> positions;
    std::vector<float> values;  // log-likelihood at each position of the grid
    float outside = 0.0F;       // beyond the grid
  };

  float at(int row, int column) const { return scores_[static_cast<std::size_t>(row) * columns_ + column]; }

  // Adds the values of a cell, shifted by its position in steps, to the scores of all positions.
  void add_cell(const CellsOfKind& kind, const Vector2d& shift) {
    const int right = static_cast<int>(std::lround(shift.x())), up = static_cast<int>(std::lround(shift.y()));
    for (int row = 0; row < rows_; ++row) {
      float* const sums = scores_.data() + static_cast<std::size_t>(row) * columns_;
      const int source = row + up;
      const bool is_inside = source >= 0 && source < rows_;
      const int begin = is_inside ? std::clamp(-right, 0, columns_) : columns_;
      const int end = is_inside ? std::clamp(columns_ - right, begin, columns_) : columns_;
      for (int i = 0; i < begin; ++i) sums[i] += kind.outside;
      if (is_inside) {
        const float* const values = kind.values.data() + static_cast<std::size_t>(source) * columns_ + right;
        for (int i = begin; i < end; ++i) sums[i] += values[i];
      }
      for (int i = end; i < columns_; ++i) sums[i] += kind.outside;
    }
  }

  bool is_peak(int row, int column) const {
    for (int y = row - 1; y <= row + 1; ++y) {
      for (int x = column - 1; x <= column + 1; ++x) {
        if (at(y, x) > at(row, column)) return false;
      }
    }
    return true;
  }

  int columns_;
  int rows_;
  std::vector<CellsOfKind> kinds_;
  std::vector<float> scores_;
};

std::vector<PlanarPose> PlanMatcher::search() const {
  constexpr int kHeadings = 240;  // 1.5 degrees
  constexpr std::size_t kMostPeaks = 40;
  CoarseSearch coarse(walls_, cells_);
  std::vector<std::pair<float, PlanarPose>> peaks;
  for (int heading = 0; heading < kHeadings; ++heading) {
    coarse.add_peaks(2.0 * std::numbers::pi * heading / kHeadings, peaks);
  }
  std::ranges::stable_sort(peaks, std::ranges::greater(), [](const auto& peak) { return peak.first; });
  std::vector<PlanarPose> starts;
  for (const auto& [score, pose] : peaks) {
    if (starts.size() == kMostPeaks) break;
    const PlanarPose& candidate = pose;
    if (std::ranges::all_of(starts, [&](const PlanarPose& other) { return is_distinct(candidate, other); })) {
      starts.push_back(candidate);
    }
  }
  std::vector<PlanarPose> poses;
  for (const PlanarPose& start : starts) poses.push_back(refined(start));
  std::ranges::stable_sort(poses, std::ranges::greater(), [this](const PlanarPose& pose) { return score(pose); });
  return poses;
}

// Vuong's statistic: mean over standard error of the differences of log-likelihoods. A block counts at most as one
// obstacle, because its cells are correlated.
double margin_between(const std::vector<double>& best, const std::vector<double>& rival) {
  const auto count = static_cast<double>(best.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < best.size(); ++i) {
    const double difference = std::clamp(best[i] - rival[i], std::log(kNotDrawn), -std::log(kNotDrawn));
    sum += difference;
    squares += difference * difference;
  }
  const double variance = squares / count - sum * sum / (count * count);
  return variance > 0.0 ? sum / std::sqrt(count * variance) : 0.0;
}

// Poses at the distance from which poses are distinct.
std::vector<PlanarPose> poses_around(const PlanarPose& pose) {
  std::vector<PlanarPose> around;
  for (int i = 0; i < 8; ++i) {
    const double direction = 0.25 * std::numbers::pi * i;
    around.push_back({pose.position + kDistinct * Vector2d(std::cos(direction), std::sin(direction)), pose.yaw});
  }
  around.push_back({pose.position, pose.yaw + kDistinctTurn});
  around.push_back({pose.position, pose.yaw - kDistinctTurn});
  return around;
}

struct WeakestRival {
  PlanRival rival;
  bool is_near = false;
};

WeakestRival weakest_rival(const PlanMatcher& matcher, const std::vector<PlanarPose>& poses) {
  const PlanarPose& best = poses.front();
  const std::vector<double> of_best = matcher.block_scores(best);
  WeakestRival weakest;
  weakest.rival.margin = std::numeric_limits<double>::infinity();
  const auto compare = [&](const PlanarPose& pose, bool is_near) {
    const double margin = margin_between(of_best, matcher.block_scores(pose));
    if (!(margin < weakest.rival.margin)) return;
    weakest = {{pose.position - best.position, std::remainder(pose.yaw - best.yaw, 2.0 * std::numbers::pi), margin},
               is_near};
  };
  for (const PlanarPose& pose : poses) {
    if (is_distinct(pose, best)) compare(pose, false);
  }
  for (const PlanarPose& pose : poses_around(best)) compare(pose, true);
  return weakest;
}

// Obstacles on walls as correspondences with the middle lines of the walls: plans draw fences thicker than they are,
// and walls are often seen from both sides. Obstacles of a block have the weight of one, because they are correlated.
std::vector<PlanCorrespondence> correspondences_at(const Similarity& plan_from_map, const WallDistances& walls,
                                                   const PlanMatcher& matcher, const Vector2d& middle,
                                                   const Similarity& ground_from_map) {
  constexpr double kHeight = 1.0;  // metres above the ground, typical of obstacles
  const Pose map_from_ground = inverse(ground_from_map.target_from_source);
  std::vector<PlanCorrespondence> all;
  std::vector<int> blocks;
  std::map<int, int> in_block;
  for (const MapCell& cell : matcher.cells()) {
    if (cell.kind != CellKind::obstacle) continue;
    const Eigen::Vector3d in_map =
        map_from_ground * Eigen::Vector3d(cell.position.x() + middle.x(), cell.position.y() + middle.y(), kHeight);
    const Vector2d on_plan = (plan_from_map * in_map).head<2>() - walls.corner_in_plan();
    const auto line = walls.line_near(on_plan);
    if (!line || line->distance > kOnWall) continue;
    const Vector2d at = line->position + walls.corner_in_plan();
    PlanCorrespondence made{"wall", in_map, at};
    made.wall = PlanWall{in_map, Eigen::Matrix3d::Zero(), at + Vector2d(-line->normal.y(), line->normal.x())};
    all.push_back(made);
    blocks.push_back(cell.block);
    ++in_block[cell.block];
  }
  for (std::size_t i = 0; i < all.size(); ++i) all[i].sigma = kOnWall * std::sqrt(in_block.at(blocks[i]));
  return all;
}

// Scales the covariance of position and heading for the few independent errors of walls: a wall is drawn or mapped
// wrong along its length.
void correlate_errors(double measurements, PlanRegistration& registration) {
  constexpr double kIndependent = 16.0;
  const double scale = std::sqrt(std::max(1.0, measurements / kIndependent));
  const Eigen::Matrix3d turn = registration.plan_from_map.target_from_source.rotation.toRotationMatrix();
  Matrix7 scales = Matrix7::Identity();
  scales.block<3, 3>(0, 0) = turn.transpose() * Eigen::Vector3d(scale, scale, 1.0).asDiagonal() * turn;
  scales.block<3, 3>(3, 3) = turn.transpose() * Eigen::Vector3d(1.0, 1.0, scale).asDiagonal() * turn;
  registration.covariance = (scales * registration.covariance * scales).eval();
}

Similarity on_plan(const PlanarPose& pose, const WallDistances& walls, const Vector2d& middle,
                   const Similarity& ground_from_map) {
  const Vector2d shift = walls.corner_in_plan() + pose.position - Eigen::Rotation2Dd(pose.yaw) * middle;
  const Pose plan_from_ground{Eigen::Quaterniond(Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ())),
                              {shift.x(), shift.y(), 0.0}};
  return {1.0, plan_from_ground * ground_from_map.target_from_source};
}

double share(const PlanMatcher& matcher, const WallDistances& walls, const PlanarPose& pose, CellKind kind,
             double largest) {
  double on_wall = 0.0, all = 0.0;
  for (const MapCell& cell : matcher.cells()) {
    if (cell.kind != kind) continue;
    all += 1.0;
    if (walls.at(pose.position + Eigen::Rotation2Dd(pose.yaw) * cell.position) <= largest) on_wall += 1.0;
  }
  return all > 0.0 ? on_wall / all : 0.0;
}

}  // namespace

std::string_view to_string(PlanMatchDoubt doubt) {
  return name_among<PlanMatchDoubt::poor>(
      {"another pose explains the map nearly as well, as on a symmetric plan: pick points",
       "the walls seen do not determine the position, as between parallel walls: pick points",
       "too few obstacles of the map are walls of the plan: check the plan and its resolution, or pick points"},
      doubt);
}

std::string describe_match(const PlanMatch& match) {
  return fmt::format(
      "obstacles on walls: {:.0f} %; the next best pose, shifted by {:.2f} m and turned by {:.0f} deg, is "
      "worse by {:.1f} sigmas ({:.1f} needed)",
      1e2 * match.explained, match.rival.shift.norm(), match.rival.turn / kDegree, match.rival.margin,
      kLeastMatchMargin);
}

std::optional<PlanMatch> match_with_plan(const MapGraph& map, const DrivingPlane& plane, const DrawnFloorPlan& plan,
                                         std::optional<double> body_height) {
  constexpr int kRounds = 20;
  GridOptions options;
  options.resolution = kCell;
  options.body_height = body_height;
  const WallDistances walls(plan);
  const std::optional<OccupancyGrid> grid = occupancy_grid(map, std::nullopt, options, plane);
  if (!grid || !walls.has_walls()) return std::nullopt;
  const std::vector<Vector2d> path = dense_path(map, grid->plan_from_map);
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& position : path) middle += position / static_cast<double>(path.size());
  std::vector<MapCell> cells = cells_of(*grid, path, middle);
  if (std::ranges::count(cells, CellKind::obstacle, &MapCell::kind) == 0) return std::nullopt;
  const PlanMatcher matcher(walls, std::move(cells));
  const std::vector<PlanarPose> poses = matcher.search();
  if (poses.empty()) return std::nullopt;
  PlanRegistrationOptions registering;
  registering.body_height = body_height.value_or(0.0);
  Similarity start = on_plan(poses.front(), walls, middle, grid->plan_from_map);
  std::optional<PlanFit> fit;
  for (int round = 0; round < kRounds; ++round) {
    const auto correspondences = correspondences_at(start, walls, matcher, middle, grid->plan_from_map);
    if (correspondences.empty()) return std::nullopt;
    fit = register_from(start, correspondences, plane, Scale::fixed, registering);
    start = fit->registration.plan_from_map;
  }
  PlanMatch match{*fit, share(matcher, walls, poses.front(), CellKind::obstacle, kOnWall), {}, {}};
  match.fit.registration.plan = plan.plan.name;
  correlate_errors(static_cast<double>(match.fit.residuals.size()), match.fit.registration);
  const WeakestRival weakest = weakest_rival(matcher, poses);
  match.rival = weakest.rival;
  if (match.rival.margin < kLeastMatchMargin) {
    match.doubt = weakest.is_near ? PlanMatchDoubt::undetermined : PlanMatchDoubt::ambiguous;
  } else if (match.explained < kLeastExplained ||
             share(matcher, walls, poses.front(), CellKind::driven, 0.0) > kMostDrivenWalls) {
    match.doubt = PlanMatchDoubt::poor;
  }
  return match;
}

}  // namespace byre
