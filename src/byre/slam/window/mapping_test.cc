#include "byre/slam/window/mapping.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/tracking/mission_scene.h"
#include "byre/slam/window/mapping_steps.h"

#include <map>
#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr KeyframeId kFirst{Origin::online, 0};
constexpr KeyframeId kNewest{Origin::online, 19};

MapWindow cut(const MapGraph& map) {
  return cut_window(map, {kNewest}, MappingOptions{}.window);
}

MapGraph extended(MapGraph map, const MappingOptions& options = {}) {
  apply(extend_map(cut(map), options), map);
  return map;
}

// A true map of twenty keyframes, every second frame; tests add errors.
class MappingOn : public ::testing::Test {
 protected:
  explicit MappingOn(const SimulationOptions& options) : mission_(quarter_circle(options)) {}

  Eigen::Vector3d true_position(const MapGraph& map, PointId id) const {
    return mission_.landmarks_in_world[static_cast<std::size_t>(true_landmark(mission_, map, id))];
  }
  Pose true_pose(KeyframeId id) const { return true_camera_from_world(mission_, 2 * id.number); }

  // Displaces a keyframe by 3 cm and half a degree.
  void displace(KeyframeId id) {
    const Pose displaced_from_camera{rotation_exp({0.3 * kDegree, 0.3 * kDegree, -0.26 * kDegree}),
                                     {0.02, -0.02, 0.01}};
    map_.move_keyframe(id, displaced_from_camera * true_pose(id), Matrix6::Identity());
  }

  SimulatedMission mission_;
  MapGraph map_ = true_map(mission_, 2, Origin::online);
};

class MappingOnCleanFeatures : public MappingOn {
 protected:
  MappingOnCleanFeatures() : MappingOn(without_noise()) {}

  // Removes every third point. Returns the landmarks of these that the newest keyframe and its neighbour both see.
  std::vector<int> forget_points() {
    std::vector<int> landmarks;
    for (const PointId id : map_.point_ids()) {
      if (id.number % 3 != 0) continue;
      const std::vector<Observation>& seen = map_.observations(id);
      const auto late = [](const Observation& observation) {
        return observation.keyframe.number >= kNewest.number - 1;
      };
      if (std::ranges::count_if(seen, late) == 2) landmarks.push_back(true_landmark(mission_, map_, id));
      map_.remove_point(id);
    }
    return landmarks;
  }
};

class MappingOnNoisyFeatures : public MappingOn {
 protected:
  static SimulationOptions with_outliers() {
    SimulationOptions options;
    options.outlier_ratio = 0.1;
    return options;
  }
  MappingOnNoisyFeatures() : MappingOn(with_outliers()) {}

  // Landmarks in view of the newest keyframe, with their points in the map.
  std::map<int, std::set<PointId>> points_of_landmarks(const MapGraph& map) const {
    std::map<int, std::set<PointId>> points;
    for (const PointId id : map.point_ids()) points[true_landmark(mission_, map, id)].insert(id);
    const std::vector<int>& seen = mission_.landmark_of_feature[2 * kNewest.number];
    std::erase_if(points, [&](const auto& entry) { return std::ranges::find(seen, entry.first) == seen.end(); });
    return points;
  }

  int count_duplicates(const MapGraph& map) const {
    const auto points = points_of_landmarks(map);
    return static_cast<int>(std::ranges::count_if(points, [](const auto& entry) { return entry.second.size() > 1; }));
  }

  // Moves the later half of a point's observations to a new point next to it.
  void split(PointId id) {
    const std::vector<Observation> observations = map_.observations(id);
    if (observations.size() < 6) return;
    const auto middle = observations.begin() + static_cast<std::ptrdiff_t>(observations.size() / 2);
    MapPoint copy = *map_.find_point(id);
    copy.position_in_world.z() += 0.005;
    copy.reference = *middle;
    const PointId other = map_.add_point(copy);
    for (auto seen = middle; seen != observations.end(); ++seen) {
      Sighting sighting = map_.find_keyframe(seen->keyframe)->sightings[static_cast<std::size_t>(seen->feature)];
      sighting.point = other;
      map_.remove_observation(*seen);
      map_.add_observation(*seen, sighting);
    }
  }
};

TEST_F(MappingOnCleanFeatures, HardlyChangesACorrectMap) {
  const MapGraph after = extended(map_);
  for (const KeyframeId id : after.keyframe_ids()) {
    EXPECT_THAT(after.camera_from_world(id), PoseNear(true_pose(id), 1e-3, 1e-3));
  }
  for (const PointId id : after.point_ids()) {
    EXPECT_THAT(after.find_point(id)->position_in_world, PointNear(true_position(after, id), 0.01));
  }
}

TEST_F(MappingOnCleanFeatures, PlacesNewPointsOnTheirLandmarks) {
  const std::vector<int> forgotten = forget_points();
  const std::uint32_t last = map_.point_ids().back().number;
  MappingOptions options;
  options.max_relative_depth_sigma = 0.3;  // corners without patches, 16 cm apart
  const MapGraph after = extended(map_, options);
  EXPECT_THAT(find_faults(after), IsEmpty());
  std::set<int> landmarks;
  for (const PointId id : after.point_ids()) {
    if (id.number <= last) continue;
    EXPECT_THAT(after.find_point(id)->position_in_world, PointNear(true_position(after, id), 0.02));
    EXPECT_GE(after.observations(id).size(), 2u);
    landmarks.insert(true_landmark(mission_, after, id));
  }
  EXPECT_GT(static_cast<double>(landmarks.size()), 0.7 * static_cast<double>(forgotten.size()));
}

TEST_F(MappingOnCleanFeatures, RejectsPointsOfUncertainDepth) {
  forget_points();
  MappingOptions options;
  options.max_relative_depth_sigma = 1e-3;
  const MapGraph after = extended(map_, options);
  EXPECT_LE(after.point_ids().back(), map_.point_ids().back());
}

TEST_F(MappingOnCleanFeatures, CorrectsADisplacedKeyframe) {
  displace(kNewest);
  EXPECT_THAT(extended(map_).camera_from_world(kNewest), PoseNear(true_pose(kNewest), 1e-3, 0.02 * kDegree));
}

TEST_F(MappingOnNoisyFeatures, CorrectsADisplacedKeyframe) {
  displace(kNewest);
  EXPECT_THAT(extended(map_).camera_from_world(kNewest), PoseNear(true_pose(kNewest), 0.01, 0.15 * kDegree));
}

TEST_F(MappingOnNoisyFeatures, CorrectsADisplacedNeighbour) {
  const KeyframeId neighbour{Origin::online, 17};
  displace(neighbour);
  EXPECT_THAT(extended(map_).camera_from_world(neighbour), PoseNear(true_pose(neighbour), 0.01, 0.15 * kDegree));
}

TEST_F(MappingOnNoisyFeatures, LeavesFixedElementsBitIdentical) {
  displace(kNewest);
  const MapGraph after = extended(map_);
  const MapWindow window = cut(map_);
  std::set<KeyframeId> movable;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (keyframe.movable) movable.insert(keyframe.id);
  }
  EXPECT_THAT(movable, Not(Contains(kFirst)));
  for (const KeyframeId id : map_.keyframe_ids()) {
    if (movable.contains(id)) continue;
    EXPECT_EQ(after.camera_from_world(id).translation, map_.camera_from_world(id).translation);
    EXPECT_EQ(after.camera_from_world(id).rotation.coeffs(), map_.camera_from_world(id).rotation.coeffs());
  }
}

TEST_F(MappingOnNoisyFeatures, FusesDuplicatePoints) {
  for (const PointId id : map_.point_ids()) split(id);
  const int before = count_duplicates(map_);
  ASSERT_GT(before, 100);
  const MapGraph after = extended(map_);
  EXPECT_LT(count_duplicates(after), 0.1 * before);
  EXPECT_THAT(find_faults(after), IsEmpty());
}

TEST_F(MappingOnNoisyFeatures, KeepsDistinctPoints) {
  const MapGraph after = extended(map_);
  int mixed = 0;
  for (const PointId id : after.point_ids()) {
    std::set<int> landmarks;
    for (const Observation& seen : after.observations(id)) {
      landmarks.insert(true_landmark(mission_, *after.find_keyframe(seen.keyframe), seen.feature));
    }
    mixed += landmarks.size() > 1 ? 1 : 0;
  }
  EXPECT_LT(mixed, 0.01 * after.point_count());
}

TEST_F(MappingOnNoisyFeatures, RemovesOutlierObservations) {
  std::vector<std::pair<Observation, Sighting>> seen;
  const std::vector<Sighting> sightings = map_.find_keyframe(kNewest)->sightings;
  for (int feature = 0; feature < static_cast<int>(sightings.size()); feature += 10) {
    const Sighting& sighting = sightings[static_cast<std::size_t>(feature)];
    if (sighting.point && map_.observations(*sighting.point).size() > 3) seen.push_back({{kNewest, feature}, sighting});
  }
  ASSERT_GT(seen.size(), 10u);
  for (const auto& [observation, sighting] : seen) map_.remove_observation(observation);
  for (std::size_t i = 0; i < seen.size(); ++i) {  // each feature gets the point of the next
    Sighting wrong = seen[i].second;
    wrong.point = seen[(i + 1) % seen.size()].second.point;
    ASSERT_TRUE(map_.add_observation(seen[i].first, wrong));
  }
  const MapGraph after = extended(map_);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto feature = static_cast<std::size_t>(seen[i].first.feature);
    EXPECT_NE(after.find_keyframe(kNewest)->sightings[feature].point, seen[(i + 1) % seen.size()].second.point);
  }
}

TEST_F(MappingOnNoisyFeatures, RemovesOldUnconfirmedPoints) {
  const std::uint32_t next = map_.point_ids().back().number + 1;
  const int old_points = add_stereo_points(map_, {Origin::online, 14});
  const int new_points = add_stereo_points(map_, kNewest);
  ASSERT_GT(old_points, 0);
  ASSERT_GT(new_points, 0);
  const MapGraph after = extended(map_);
  int old_left = 0;
  int new_left = 0;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(old_points + new_points); ++i) {
    if (after.find_point({Origin::online, next + i}) == nullptr) continue;
    ++(i < static_cast<std::uint32_t>(old_points) ? old_left : new_left);
  }
  EXPECT_LE(old_left, 0.1 * old_points);  // one may be confirmed by chance
  EXPECT_GE(new_left, 0.9 * new_points);
}

TEST_F(MappingOnNoisyFeatures, KeepsOldPointsHiddenByDirt) {
  const std::uint32_t next = map_.point_ids().back().number + 1;
  const int old_points = add_stereo_points(map_, {Origin::online, 14});
  MapWindow window = cut_window(MapView(nullptr, map_), {kNewest}, {});
  ImageMask hidden;
  for (std::size_t cell = 0; cell < ImageMask::kCells; ++cell) hidden.set(cell, true);
  remove_weak_points(window, kNewest, hidden);
  const WindowKeyframe& newest = window.keyframes.front();
  int waiting = 0, in_view = 0;
  for (const WindowPoint& point : window.points) {
    if (!point.id || point.id->number < next || point.id->number >= next + static_cast<std::uint32_t>(old_points))
      continue;
    const Eigen::Vector3d in_camera = newest.keyframe.camera_from_world * point.point.position_in_world;
    const Rig& rig = window.rig_of(newest);
    const bool is_in_view = in_camera.z() > 0.0 && rig.contains(rig.project(in_camera).head<2>());
    in_view += is_in_view ? 1 : 0;
    waiting += is_in_view && !point.removed ? 1 : 0;
    EXPECT_TRUE(is_in_view || point.removed);
  }
  EXPECT_GT(in_view, 0);
  EXPECT_EQ(waiting, in_view);
}

TEST_F(MappingOnNoisyFeatures, UpdatesThePointsItObserves) {
  const MapGraph after = extended(map_);
  for (const PointId id : after.point_ids()) {
    const MapPoint& point = *after.find_point(id);
    EXPECT_NEAR(point.mean_viewing_direction.norm(), 1.0f, 1e-5f);
    EXPECT_GT(point.max_distance, point.min_distance);
    EXPECT_THAT(after.observations(id), Contains(point.reference));
  }
}

TEST(ExtendMap, RemovesRedundantKeyframes) {
  const MapGraph map = true_map(quarter_circle({}), 1, Origin::online);  // a keyframe every 8 cm
  const KeyframeId newest = map.keyframe_ids().back();
  const KeyframeId before_it{Origin::online, newest.number - 1};
  MapGraph after = map;
  apply(extend_map(cut_window(map, {before_it, newest}, {}), {}), after);
  EXPECT_LT(after.keyframe_count(), map.keyframe_count());
  EXPECT_NE(after.find_keyframe(kFirst), nullptr);
  EXPECT_NE(after.find_keyframe(before_it), nullptr);
  EXPECT_NE(after.find_keyframe(newest), nullptr);
  EXPECT_THAT(find_faults(after), IsEmpty());
  for (const PointId id : map.point_ids()) {  // points seen by several keyframes remain
    if (map.observations(id).size() < 8) continue;
    EXPECT_NE(after.find_point(id), nullptr);
  }
}

TEST(ExtendMap, KeepsAMapOfOneKeyframe) {
  const SimulatedMission mission = quarter_circle({});
  const auto map = initialise_stereo(mission.frames[0], mission.rig, 50);
  ASSERT_TRUE(map);
  const MapDelta delta = extend_map(cut_window(*map, {kFirst}, {}), {});
  EXPECT_THAT(delta.moved_keyframes, IsEmpty());
  EXPECT_THAT(delta.removed_points, IsEmpty());
}

// All numbers of a delta that could differ between runs.
std::vector<double> flatten(const MapDelta& delta) {
  std::vector<double> numbers;
  const auto append = [&](const auto& matrix) {
    for (const auto value : matrix.reshaped()) numbers.push_back(static_cast<double>(value));
  };
  const auto append_point = [&](const MapPoint& point) {
    append(point.position_in_world);
    append(point.covariance);
    append(point.mean_viewing_direction);
    numbers.insert(numbers.end(), {point.max_distance, static_cast<double>(point.reference.keyframe.number),
                                   static_cast<double>(point.reference.feature)});
  };
  const auto append_observation = [&](const NewObservation& seen) {
    append(seen.sighting.pixel);
    numbers.insert(numbers.end(), {static_cast<double>(seen.keyframe.number), static_cast<double>(seen.feature),
                                   static_cast<double>(seen.sighting.point ? seen.sighting.point->number : 0)});
  };
  for (const MovedKeyframe& moved : delta.moved_keyframes) {
    numbers.push_back(moved.id.number);
    append(moved.camera_from_world.translation);
    append(moved.camera_from_world.rotation.coeffs());
    append(moved.covariance);
  }
  for (const UpdatedPoint& updated : delta.updated_points) append_point(updated.point);
  for (const OnlinePointId id : delta.removed_points) numbers.push_back(id.number);
  for (const RemovedObservation& removed : delta.removed_observations) numbers.push_back(removed.point.number);
  for (const NewObservation& seen : delta.new_observations) append_observation(seen);
  for (const NewPoint& made : delta.new_points) {
    append_point(made.point);
    for (const NewObservation& seen : made.observations) append_observation(seen);
  }
  for (const OnlineKeyframeId id : delta.removed_keyframes) numbers.push_back(id.number);
  return numbers;
}

TEST_F(MappingOnNoisyFeatures, IsDeterministic) {
  displace(kNewest);
  for (const PointId id : map_.point_ids()) split(id);
  const MapWindow window = cut(map_);
  const std::vector<double> first = flatten(extend_map(window, {}));
  EXPECT_GT(first.size(), 1000u);
  EXPECT_EQ(first, flatten(extend_map(window, {})));
}

}  // namespace
}  // namespace byre
