#include "byre/map/plan/occupancy_grid.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/map/plan/driven_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::Each;
using testing::Ge;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Le;
using testing::SizeIs;

constexpr double kSigma = 0.005;  // metres, of well determined points
constexpr double kStep = 0.25;    // metres between keyframes

// A robot drives along x from 0 to 6 m, its camera 0.9 m above the floor. The level frame has z up from the floor.
class GridScene {
 public:
  explicit GridScene(const Pose& map_from_level = {}, const std::vector<Pose>& level_from_body = straight(),
                     Timestamp interval = std::chrono::seconds(1))
      : map_from_level_(map_from_level) {
    rig_ = looking_down();
    map_.add_rig(rig_);
    for (const Pose& body : level_from_body) {
      Keyframe keyframe;
      keyframe.frame.time = interval * map_.keyframe_count();
      keyframe.frame.features =
          std::make_shared<Features>(320, 240, std::vector<Keypoint>(kFeatures, Keypoint{{1.0f, 1.0f}}),
                                     std::vector<Descriptor>(kFeatures), std::vector<Patch>{});
      keyframe.camera_from_world = inverse(map_from_level * body * rig_.body_from_camera);
      map_.add_keyframe(keyframe);
    }
    used_.resize(level_from_body.size());
  }

  static std::vector<Pose> straight() {
    std::vector<Pose> path;
    for (int i = 0; i <= 24; ++i) path.push_back(on_floor(kStep * i, 0.0, 0.0));
    return path;
  }

  // A point observed by `count` keyframes from number `first` on.
  void add_point(const Vector3d& in_level, int first, int count, double sigma = kSigma) {
    MapPoint point;
    point.position_in_world = map_from_level_ * in_level;
    point.covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    point.reference = {{Origin::offline, static_cast<std::uint32_t>(first)}, used_[static_cast<std::size_t>(first)]};
    const PointId id = map_.add_point(point);
    for (int i = first; i < first + count; ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      EXPECT_TRUE(map_.add_observation({{Origin::offline, number}, used_[number]++}, {id}));
    }
  }

  // Points along x at three heights, each observed by the four keyframes before it.
  void add_wall(double from_x, double to_x, double y, double spacing) {
    const int count = 1 + static_cast<int>(std::lround((to_x - from_x) / spacing));
    for (int i = 0; i < count; ++i) {
      const double x = from_x + i * spacing;
      const int first = std::clamp(static_cast<int>(x / kStep) - 4, 0, 21);
      for (const double z : {0.3, 0.75, 1.25}) add_point({x, y, z}, first, 4);
    }
  }

  const MapGraph& map() const { return map_; }
  OccupancyGrid grid(const GridOptions& options = {}) const { return occupancy_grid(map_, {}, options).value(); }

 private:
  static constexpr std::size_t kFeatures = 400;

  Pose map_from_level_;
  Rig rig_;
  MapGraph map_{Origin::offline};
  std::vector<int> used_;  // features per keyframe
};

// Occupancy at a point of the plan; empty outside the grid.
std::optional<int> occupancy_at(const OccupancyGrid& grid, const Vector2d& point) {
  const Vector2d pixel = grid.plan.pixel_at(point);
  const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
  if (column < 0 || row < 0 || column >= grid.plan.width || row >= grid.plan.height) return std::nullopt;
  return grid.occupancy[static_cast<std::size_t>(row * grid.plan.width + column)];
}

std::vector<Vector2d> occupied(const OccupancyGrid& grid) {
  std::vector<Vector2d> points;
  for (int row = 0; row < grid.plan.height; ++row) {
    for (int column = 0; column < grid.plan.width; ++column) {
      const std::int8_t value = grid.occupancy[static_cast<std::size_t>(row * grid.plan.width + column)];
      if (value == kOccupiedPixel) points.push_back(grid.plan.point_at({column, row}));
    }
  }
  return points;
}

// Occupancies along x in steps of a cell.
std::vector<int> along(const OccupancyGrid& grid, double from_x, double to_x, double y) {
  std::vector<int> values;
  for (double x = from_x; x <= to_x; x += 0.05) values.push_back(occupancy_at(grid, {x, y}).value());
  return values;
}

TEST(OccupancyGrid, HasAWallAtItsCells) {
  GridScene scene;
  scene.add_wall(1.025, 5.025, 2.025, 0.1);
  const OccupancyGrid grid = scene.grid();
  EXPECT_THAT(along(grid, 1.03, 5.02, 2.025), Each(kOccupiedPixel));
  for (const Vector2d& cell : occupied(grid)) {
    EXPECT_NEAR(cell.y(), 2.025, 1e-6);
    EXPECT_THAT(cell.x(), AllOf(Ge(1.0), Le(5.05)));
  }
}

TEST(OccupancyGrid, IsFreeAlongRaysAndUnknownElsewhere) {
  GridScene scene;
  scene.add_wall(1.025, 5.025, 2.025, 0.1);
  scene.add_point({5.5, -2.0, 0.5}, 20, 4);
  const OccupancyGrid grid = scene.grid();
  EXPECT_THAT(along(grid, 2.0, 4.5, 1.0), Each(kFreePixel));
  EXPECT_THAT(along(grid, 0.0, 4.0, -1.0), Each(kUnknownPixel));
  EXPECT_EQ(occupancy_at(grid, {5.525, -1.975}), kOccupiedPixel);
}

TEST(OccupancyGrid, IsFreeWhereTheRobotDrove) {
  GridScene scene;
  for (double x = 0.5; x < 5.5; x += 0.1) scene.add_point({x, 0.225, 0.5}, 0, 4);
  const OccupancyGrid grid = scene.grid({.footprint_radius = 0.25});
  for (const double y : {-0.225, 0.0, 0.225}) EXPECT_THAT(along(grid, 0.0, 6.0, y), Each(kFreePixel));
  EXPECT_THAT(occupied(grid), IsEmpty());
  EXPECT_THAT(occupied(scene.grid({.footprint_radius = 0.1})), SizeIs(testing::Gt(40u)));
}

// Keyframes 3 m apart, 1 s or 10 s after each other.
TEST(OccupancyGrid, IsFreeBetweenKeyframesOfAFastVehicle) {
  std::vector<Pose> path;
  for (int i = 0; i < 5; ++i) path.push_back(on_floor(3.0 * i, 0.0, 0.0));
  EXPECT_THAT(along(GridScene({}, path).grid(), 0.0, 12.0, 0.2), Each(kFreePixel));
  const OccupancyGrid slow = GridScene({}, path, std::chrono::seconds(10)).grid();
  EXPECT_EQ(occupancy_at(slow, {3.0, 0.0}), kFreePixel);
  EXPECT_EQ(occupancy_at(slow, {4.5, 0.0}), kUnknownPixel);
}

// The chord of a quarter circle of 3 m.
TEST(OccupancyGrid, CutsNoCorners) {
  std::vector<Pose> path;
  for (int i = 0; i < 3; ++i) {
    const double turn = 0.5 * std::numbers::pi * i;
    path.push_back(on_floor(3.0 * std::sin(turn), 3.0 * (1.0 - std::cos(turn)), turn));
  }
  const OccupancyGrid grid = GridScene({}, path).grid();
  EXPECT_EQ(occupancy_at(grid, {3.0, 3.0}), kFreePixel);
  EXPECT_EQ(occupancy_at(grid, {1.5, 1.5}), kUnknownPixel);
}

TEST(OccupancyGrid, IgnoresPointsBelowAndAboveTheHeights) {
  GridScene scene;
  for (double x = 1.0; x < 5.0; x += 0.1) {
    scene.add_point({x, 1.0, 0.02}, 0, 4);
    scene.add_point({x, 1.5, 2.2}, 0, 4);
  }
  EXPECT_THAT(occupied(scene.grid()), IsEmpty());
  EXPECT_THAT(occupied(scene.grid({.low = 0.0})),
              Each(testing::Truly([](const Vector2d& cell) { return std::abs(cell.y() - 1.0) < 0.06; })));
  EXPECT_FALSE(occupied(scene.grid({.low = 0.0})).empty());
  EXPECT_FALSE(occupied(scene.grid({.high = 2.5})).empty());
}

TEST(OccupancyGrid, IgnoresUncertainPoints) {
  GridScene scene;
  for (double x = 1.0; x < 5.0; x += 0.1) scene.add_point({x, 2.0, 0.5}, 0, 4, 0.3);
  EXPECT_THAT(occupied(scene.grid()), IsEmpty());
}

TEST(OccupancyGrid, IgnoresPointsWithOneObservation) {
  GridScene scene;
  scene.add_point({3.0, 2.0, 0.5}, 0, 1);
  EXPECT_THAT(occupied(scene.grid()), IsEmpty());
}

// A cell of the layer that the rays pass, seen by two keyframes before something moved away.
TEST(OccupancyGrid, ForgetsThingsThatRaysPassLater) {
  GridScene scene;
  scene.add_point({4.025, 1.025, 0.9}, 0, 2);
  EXPECT_EQ(occupancy_at(scene.grid(), {4.025, 1.025}), kOccupiedPixel);
  for (int i = 2; i < 12; ++i) {
    const Vector3d camera = {kStep * i + 0.3, 0.0, 0.9};
    scene.add_point(camera + 2.0 * (Vector3d(4.025, 1.025, 0.9) - camera), i, 2);
  }
  EXPECT_EQ(occupancy_at(scene.grid(), {4.025, 1.025}), kFreePixel);
}

TEST(OccupancyGrid, JoinsPointsOfALineNarrowerThanTheRobot) {
  GridScene scene;
  scene.add_wall(1.025, 5.025, 2.025, 0.4);
  EXPECT_THAT(along(scene.grid(), 1.03, 5.02, 2.025), Each(kOccupiedPixel));
  const OccupancyGrid narrow = scene.grid({.footprint_radius = 0.15});
  EXPECT_EQ(occupancy_at(narrow, {3.025, 2.025}), kOccupiedPixel);
  EXPECT_NE(occupancy_at(narrow, {3.225, 2.025}), kOccupiedPixel);
}

TEST(OccupancyGrid, LeavesDoorsOpen) {
  GridScene scene;
  scene.add_wall(1.025, 2.525, 2.025, 0.1);
  scene.add_wall(3.425, 5.025, 2.025, 0.1);
  const OccupancyGrid grid = scene.grid();
  EXPECT_THAT(along(grid, 2.58, 3.37, 2.025), Each(testing::Ne(kOccupiedPixel)));
  EXPECT_EQ(occupancy_at(grid, {2.525, 2.025}), kOccupiedPixel);
  EXPECT_EQ(occupancy_at(grid, {3.425, 2.025}), kOccupiedPixel);
}

TEST(OccupancyGrid, JoinsNoScatteredPoints) {
  GridScene scene;
  int i = 0;
  for (double x = 1.0; x < 5.0; x += 0.3) {
    for (double y = 1.5; y < 3.0; y += 0.3) scene.add_point({x, y + 0.1 * (i++ % 3), 0.5}, 0, 4);
  }
  EXPECT_LE(occupied(scene.grid()).size(), 2u * static_cast<std::size_t>(i)) << "no more than the points' own cells";
}

TEST(OccupancyGrid, HasTheFrameOfTheFloorPlan) {
  GridScene scene(kMapFromLevel);
  scene.add_wall(1.0, 5.0, 2.0, 0.1);
  PlanRegistration registration;
  registration.plan_from_map.target_from_source.rotation =
      rotation_exp({0.0, 0.0, 0.5}) * kMapFromLevel.rotation.conjugate();
  registration.plan_from_map.target_from_source.translation = {100.0, -50.0, 0.0};
  const OccupancyGrid grid = occupancy_grid(scene.map(), registration).value();
  const Vector2d on_wall = (registration.plan_from_map * (kMapFromLevel * Vector3d(3.0, 2.0, 0.0))).head<2>();
  const Vector2d on_path = (registration.plan_from_map * (kMapFromLevel * Vector3d(3.0, 0.0, 0.0))).head<2>();
  EXPECT_EQ(occupancy_at(grid, on_wall), kOccupiedPixel);
  EXPECT_EQ(occupancy_at(grid, on_path), kFreePixel);
}

TEST(OccupancyGrid, AppliesTheScaleOfTheRegistration) {
  GridScene scene;
  scene.add_wall(1.0, 5.0, 2.0, 0.05);
  PlanRegistration registration;
  registration.plan_from_map.scale = 1.4;
  const OccupancyGrid grid = occupancy_grid(scene.map(), registration).value();
  EXPECT_EQ(occupancy_at(grid, 1.4 * Vector2d(3.0, 2.0)), kOccupiedPixel);
  EXPECT_EQ(occupancy_at(grid, 1.4 * Vector2d(3.0, 0.0)), kFreePixel);
}

TEST(OccupancyGrid, LevelsATiltedMapWithoutAPlan) {
  GridScene scene(kMapFromLevel);
  scene.add_wall(1.0, 5.0, 2.0, 0.1);
  const OccupancyGrid grid = scene.grid();
  const auto on_grid = [&](const Vector3d& in_level) -> Vector3d {
    return grid.plan_from_map * (kMapFromLevel * in_level);
  };
  EXPECT_NEAR(on_grid({4.0, 0.0, 0.0}).z(), 0.0, 1e-3);
  EXPECT_NEAR(on_grid({4.0, 1.0, 1.2}).z(), 1.2, 0.01);
  EXPECT_EQ(occupancy_at(grid, on_grid({3.0, 2.0, 0.0}).head<2>()), kOccupiedPixel);
  EXPECT_EQ(occupancy_at(grid, on_grid({3.0, 0.0, 0.0}).head<2>()), kFreePixel);
}

TEST(OccupancyGrid, HasTheOriginAndXAxisOfALevelMap) {
  GridScene scene;
  scene.add_wall(1.0, 5.0, 2.0, 0.1);
  const OccupancyGrid grid = scene.grid();
  for (const Vector3d& point : {Vector3d(0.0, 0.0, 0.0), Vector3d(5.0, -3.0, 1.0)}) {
    EXPECT_THAT(grid.plan_from_map * point, PointNear(point, 1e-3));
  }
}

TEST(OccupancyGrid, MeasuresHeightsFromTheFloorBelowTheBody) {
  GridScene scene;
  for (double x = 1.0; x < 5.0; x += 0.1) scene.add_point({x, 2.0, -0.4}, 0, 4);
  EXPECT_THAT(occupied(scene.grid()), IsEmpty());
  EXPECT_FALSE(occupied(scene.grid({.body_height = 0.9})).empty());
}

// The body is the camera, 0.9 m above the floor.
TEST(OccupancyGrid, NeedsTheHeightOfACamera) {
  MapGraph map(Origin::offline);
  Rig rig = looking_down();
  rig.body_from_camera = {};
  map.add_rig(rig);
  for (const Pose& body : GridScene::straight()) {
    Keyframe keyframe;
    keyframe.frame.time = std::chrono::seconds(map.keyframe_count());
    keyframe.camera_from_world = inverse(body * looking_down().body_from_camera);
    map.add_keyframe(keyframe);
  }
  EXPECT_THAT([&] { occupancy_grid(map, {}); },
              testing::ThrowsMessage<InputError>(HasSubstr("its height above the floor is unknown")));
  const OccupancyGrid grid = occupancy_grid(map, {}, {.body_height = 0.9}).value();
  EXPECT_THAT(grid.plan_from_map * Vector3d(1.0, 2.0, 0.0), PointNear(Vector3d(1.0, 2.0, 0.0), 1e-3));
  EXPECT_NO_THROW(occupancy_grid(map, PlanRegistration{}));
}

// Up a ramp of 10 % from x = 10 m to 16 m, and back.
TEST(OccupancyGrid, FollowsARamp) {
  constexpr double kSlope = 0.1;
  GridScene scene({}, driven(kSlope));
  const auto rise = [](double x) { return kSlope * std::clamp(x - 10.0, 0.0, 6.0); };
  for (int i = 2; i < 57; ++i) {
    const double x = 0.5 * i;
    scene.add_point({x, -1.0, rise(x)}, i - 2, 4);
    scene.add_point({x, -2.0, rise(x) + 0.5}, i - 2, 4);
  }
  const std::vector<Vector2d> cells = occupied(scene.grid());
  EXPECT_THAT(cells, SizeIs(Ge(55u)));
  for (const Vector2d& cell : cells) EXPECT_LT(cell.y(), -1.8) << cell.x();
}

TEST(OccupancyGrid, RefusesMoreThanAHundredMillionCells) {
  GridScene scene;
  scene.add_wall(1.0, 5.0, 2.0, 0.1);
  try {
    scene.grid({.resolution = 0.0001});
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("the limit is 100 million"), HasSubstr("choose a resolution of 0.01 m")));
  }
}

TEST(OccupancyGrid, IsEmptyWithoutADrivenFloor) {
  EXPECT_FALSE(occupancy_grid(MapGraph(Origin::offline), {}));
  std::vector<Pose> flown;
  for (int i = 0; i <= 24; ++i)
    flown.push_back({Eigen::Quaterniond::Identity(), {0.1 * i, (i % 5) * 0.3, (i % 3) * 0.8}});
  EXPECT_FALSE(occupancy_grid(GridScene({}, flown).map(), {}));
}

TEST(OccupancyGrid, IsDeterministic) {
  GridScene scene;
  scene.add_wall(1.0, 5.0, 2.0, 0.13);
  EXPECT_EQ(scene.grid().occupancy, scene.grid().occupancy);
}

}  // namespace
}  // namespace byre
