#include "byre/map/plan/plan_matching.h"

#include "byre/geometry/degrees.h"
#include "byre/map/plan/driven_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMargin = 1.0;  // metres of the plan around the building

// A hall with walls that reach from its sides towards the lane in the middle, and a robot that drives up and down the
// lane. It sees walls within 12 m, and objects that the plan does not have.
class Hall {
 public:
  enum class Shape { unambiguous, symmetric, endless };

  Hall(std::uint64_t seed, Shape shape) : random_(seed), shape_(shape) {
    length_ = uniform(14.0, 26.0);
    half_width_ = uniform(3.5, 6.0);
    const bool is_open = shape == Shape::endless;
    add_wall({0.0, -half_width_}, {length_, -half_width_});
    add_wall({0.0, half_width_}, {length_, half_width_});
    if (is_open) return;
    add_wall({0.0, -half_width_}, {0.0, half_width_});
    add_wall({length_, -half_width_}, {length_, half_width_});
    for (int i = 0; i < 6; ++i) {
      const double x = uniform(1.5, length_ - 1.5), side = i % 2 == 0 ? 1.0 : -1.0;
      const double reach = uniform(1.8, half_width_ - 0.6);
      add_wall({x, side * half_width_}, {x, side * reach});
      if (shape == Shape::symmetric) add_wall({length_ - x, -side * half_width_}, {length_ - x, -side * reach});
    }
  }

  DrawnFloorPlan plan() const {
    DrawnFloorPlan drawn;
    FloorPlan& plan = drawn.plan;
    constexpr double kPixel = 0.05;
    plan.name = "hall.yaml";
    plan.width = static_cast<int>((length_ + 2.0 * kMargin) / kPixel);
    plan.height = static_cast<int>((2.0 * half_width_ + 2.0 * kMargin) / kPixel);
    plan.metres_per_pixel << kPixel, 0.0, 0.0, -kPixel;
    plan.top_left_in_plan << -kMargin, half_width_ + kMargin;
    drawn.occupancy.assign(static_cast<std::size_t>(plan.width * plan.height), kFreePixel);
    for (const auto& [from, to] : walls_) {
      const int steps = static_cast<int>((to - from).norm() / 0.02);
      for (int i = 0; i <= steps; ++i) {
        const Vector2d pixel = plan.pixel_at(from + (to - from) * i / steps);
        const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
        drawn.occupancy[static_cast<std::size_t>(row * plan.width + column)] = kOccupiedPixel;
      }
    }
    return drawn;
  }

  // Two rows of keyframes along the lane; the frame of the map is kMapFromLevel, turned and shifted.
  MapGraph map() {
    std::vector<Pose> path;
    const int count = static_cast<int>((length_ - 4.0) / 0.4);
    for (int i = 0; i < 2 * count; ++i) {
      const bool is_back = i >= count;
      path.push_back(on_floor(2.0 + 0.4 * (is_back ? 2 * count - 1 - i : i), is_back ? 0.7 : -0.7,
                              is_back ? std::numbers::pi : 0.0));
    }
    MapGraph map(Origin::offline);
    map.add_rig(looking_down());
    std::vector<std::pair<Vector3d, int>> points;  // in the level frame, with the first of two keyframes
    for (int i = 0; i + 1 < static_cast<int>(path.size()); ++i) {
      for (int ray = 0; ray < 30; ++ray) add_point(path[static_cast<std::size_t>(i)], i, points);
    }
    for (const Pose& body : path) {
      Keyframe keyframe;
      keyframe.frame.time = std::chrono::seconds(map.keyframe_count());
      keyframe.frame.features =
          std::make_shared<const Features>(320, 240, std::vector<Keypoint>(kFeatures, Keypoint{{1.0F, 1.0F}}),
                                           std::vector<Descriptor>(kFeatures), std::vector<Patch>{});
      keyframe.camera_from_world = inverse(map_from_plan() * body * looking_down().body_from_camera);
      map.add_keyframe(keyframe);
    }
    std::vector<int> used(path.size(), 0);
    for (const auto& [position, first] : points) {
      const auto number = static_cast<std::uint32_t>(first);
      MapPoint point;
      point.position_in_world = map_from_plan() * position;
      point.covariance = 1e-4 * Eigen::Matrix3d::Identity();
      point.reference = {{Origin::offline, number}, used[number]};
      const PointId id = map.add_point(point);
      map.add_observation({{Origin::offline, number}, used[number]++}, {id});
      map.add_observation({{Origin::offline, number + 1}, used[number + 1]++}, {id});
    }
    return map;
  }

  Pose map_from_plan() const { return kMapFromLevel; }

 private:
  static constexpr std::size_t kFeatures = 120;

  double uniform(double from, double to) { return std::uniform_real_distribution(from, to)(random_); }

  void add_wall(const Vector2d& from, const Vector2d& to) { walls_.emplace_back(from, to); }

  // The end of a ray in a random direction ahead; on a wall, or for one in six at an object before it.
  void add_point(const Pose& body, int keyframe, std::vector<std::pair<Vector3d, int>>& points) {
    const Vector3d ahead = body.rotation * Vector3d::UnitX();
    const double angle = std::atan2(ahead.y(), ahead.x()) + uniform(-40.0, 40.0) * kDegree;
    const Vector2d start = body.translation.head<2>(), ray(std::cos(angle), std::sin(angle));
    double range = 12.0;
    bool is_hit = false;
    for (const auto& [from, to] : walls_) {
      Eigen::Matrix2d system;
      system << ray, from - to;
      if (std::abs(system.determinant()) < 1e-6) continue;
      const Vector2d at = system.inverse() * (from - start);
      if (at.x() < 0.0 || at.x() > range || at.y() < 0.0 || at.y() > 1.0) continue;
      range = at.x();
      is_hit = true;
    }
    if (!is_hit) return;
    if (uniform(0.0, 1.0) < 1.0 / 6.0) range *= uniform(0.6, 1.0);
    const Vector2d end = start + (range + std::normal_distribution(0.0, 0.02)(random_)) * ray;
    points.emplace_back(Vector3d(end.x(), end.y(), uniform(0.3, 1.5)), keyframe);
  }

  std::mt19937_64 random_;
  Shape shape_;
  double length_ = 0.0;
  double half_width_ = 0.0;
  std::vector<std::pair<Vector2d, Vector2d>> walls_;
};

std::optional<PlanMatch> match(Hall& hall) {
  const MapGraph map = hall.map();
  return match_with_plan(map, require_driving_plane(map, {}, "hall"), hall.plan());
}

void find_the_map_in_halls(std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    Hall hall(seed, Hall::Shape::unambiguous);
    const std::optional<PlanMatch> found = match(hall);
    ASSERT_TRUE(found.has_value());
    EXPECT_FALSE(found->doubt.has_value()) << "seed " << seed << ": " << describe_match(*found);
    const Pose error = found->fit.registration.plan_from_map.target_from_source * hall.map_from_plan();
    EXPECT_LT(error.translation.head<2>().norm(), 0.1) << "seed " << seed;
    EXPECT_LT(angle_between(error.rotation, Eigen::Quaterniond::Identity()), 0.5 * kDegree) << "seed " << seed;
    const Vector3d centre = inverse(found->fit.registration.plan_from_map.target_from_source) * Vector3d(8.0, 0.0, 0.0);
    const double sigma = std::sqrt(0.5 * plan_covariance_at(found->fit.registration, centre).trace());
    EXPECT_LT((error * Vector3d(8.0, 0.0, 0.0) - Vector3d(8.0, 0.0, 0.0)).head<2>().norm(), 4.0 * sigma)
        << "seed " << seed;
  }
}

#ifdef BYRE_SANITIZED  // a search takes half a minute
constexpr std::uint64_t kHalls = 1;
#else
constexpr std::uint64_t kHalls = 4;
#endif

TEST(PlanMatching, FindsTheMapInHalls) {
  find_the_map_in_halls(1, kHalls);
}

TEST(LongRunPlanMatching, FindsTheMapInFurtherHalls) {
  find_the_map_in_halls(5, 20);
}

void doubt_symmetric_halls(std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    Hall hall(seed, Hall::Shape::symmetric);
    const std::optional<PlanMatch> found = match(hall);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->doubt, PlanMatchDoubt::ambiguous) << "seed " << seed << ": " << describe_match(*found);
    EXPECT_NEAR(std::abs(found->rival.turn), std::numbers::pi, 2.0 * kDegree) << "seed " << seed;
  }
}

TEST(PlanMatching, IsAmbiguousInSymmetricHalls) {
  doubt_symmetric_halls(1, std::min<std::uint64_t>(kHalls, 3));
}

TEST(LongRunPlanMatching, IsAmbiguousInFurtherSymmetricHalls) {
  doubt_symmetric_halls(4, 10);
}

TEST(PlanMatching, IsDoubtedBetweenParallelWalls) {
  Hall hall(1, Hall::Shape::endless);
  const std::optional<PlanMatch> found = match(hall);
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->doubt.has_value()) << describe_match(*found);
}

TEST(PlanMatching, IsDoubtedOnThePlanOfAnotherBuilding) {
  Hall hall(1, Hall::Shape::unambiguous), other(2, Hall::Shape::unambiguous);
  const MapGraph map = hall.map();
  const auto found = match_with_plan(map, require_driving_plane(map, {}, "hall"), other.plan());
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->doubt.has_value()) << describe_match(*found);
}

TEST(PlanMatching, IsEmptyWithoutWalls) {
  Hall hall(1, Hall::Shape::unambiguous);
  const MapGraph map = hall.map();
  DrawnFloorPlan plan = hall.plan();
  std::ranges::fill(plan.occupancy, kFreePixel);
  EXPECT_FALSE(match_with_plan(map, require_driving_plane(map, {}, "hall"), plan).has_value());
}

TEST(PlanMatching, ReportsARemedyForEachDoubt) {
  for (const PlanMatchDoubt doubt : {PlanMatchDoubt::ambiguous, PlanMatchDoubt::undetermined, PlanMatchDoubt::poor}) {
    EXPECT_FALSE(to_string(doubt).empty());
  }
}

}  // namespace
}  // namespace byre
