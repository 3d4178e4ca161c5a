// Mapping next to a fixed map: online data adapt, offline data do not change.

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/map/map_file.h"
#include "byre/slam/loops/global_mapping.h"
#include "byre/slam/window/hybrid_scene.h"
#include "byre/slam/window/mapping_steps.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Lt;

constexpr KeyframeId kLastKeyframe{Origin::online, 19};

struct MeanError {
  double position = 0.0;  // metres
  double rotation = 0.0;  // radians
};

// Errors of the online keyframes in the frame of the offline map, without alignment.
MeanError mean_error(const HybridScene& scene) {
  MeanError mean;
  for (const KeyframeId id : scene.online.keyframe_ids()) {
    const Pose off = inverse(scene.online.camera_from_world(id)) * scene.true_pose(id);
    mean.position += off.translation.norm() / scene.online.keyframe_count();
    mean.rotation += rotation_log(off.rotation).norm() / scene.online.keyframe_count();
  }
  return mean;
}

double median_point_error(const HybridScene& scene) {
  std::vector<double> errors;
  for (const PointId id : scene.online.point_ids()) {
    const int landmark = true_landmark(scene.second, scene.online, id);
    if (landmark < 0) continue;
    const Eigen::Vector3d& truth = scene.second.landmarks_in_world[static_cast<std::size_t>(landmark)];
    errors.push_back((scene.online.find_point(id)->position_in_world - truth).norm());
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::ranges::nth_element(errors, middle);
  return *middle;
}

// The map file of a copy without gaps in ids.
std::vector<std::byte> bytes_of(const MapGraph& offline) {
  StoredMap stored;
  stored.map = offline_copy(offline);
  stored.recordings.emplace_back();
  return write_map(stored);
}

// Displacement of an online map: 5 cm and 1 degree.
const Pose kDisplacement{rotation_exp(kDegree * Eigen::Vector3d(0.6, 0.0, 0.8)), {0.03, -0.04, 0.0}};

TEST(HybridMapping, PullsADisplacedOnlineMapIntoTheOfflineFrame) {
  HybridScene scene = true_hybrid_scene({});
  displace(scene.online, kDisplacement);
  const MeanError before = mean_error(scene);
  map_in_order(scene, {});
  const MeanError after = mean_error(scene);
  EXPECT_THAT(before.position, Gt(0.03));
  EXPECT_THAT(before.rotation, Gt(0.9 * kDegree));
  EXPECT_THAT(after.position, Lt(0.006));
  EXPECT_THAT(after.rotation, Lt(0.08 * kDegree));
  EXPECT_THAT(find_faults(scene.online), IsEmpty());
}

TEST(HybridMapping, MovesOnlinePointsExactlyOnCleanFeatures) {
  HybridScene scene = true_hybrid_scene(without_noise());
  displace(scene.online, kDisplacement);
  const double before = median_point_error(scene);
  map_in_order(scene, {});
  EXPECT_THAT(before, Gt(0.05));
  EXPECT_THAT(median_point_error(scene), Lt(0.002));
  EXPECT_THAT(mean_error(scene).position, Lt(0.001));
}

TEST(HybridMapping, LeavesTheOfflineMapBitIdentical) {
  SimulationOptions options;
  options.outlier_ratio = 0.1;
  HybridScene scene = true_hybrid_scene(options);
  displace(scene.online, kDisplacement);
  const std::vector<std::byte> before = bytes_of(scene.offline);
  map_in_order(scene, {});
  const MapWindow whole = whole_map(scene.view());
  apply_correction(adjust_map(MapWindow(whole), whole, {}, {}), whole, scene.online);
  EXPECT_EQ(bytes_of(scene.offline), before);
  EXPECT_THAT(find_faults(scene.offline), IsEmpty());
  EXPECT_THAT(find_faults(scene.online), IsEmpty());
}

TEST(HybridMapping, MovesTheFirstKeyframeToo) {
  HybridScene scene = true_hybrid_scene({});
  displace(scene.online, kDisplacement);
  map_in_order(scene, {});
  const KeyframeId first = scene.online.keyframe_ids().front();
  EXPECT_THAT(scene.online.camera_from_world(first), PoseNear(scene.true_pose(first), 0.01, 0.1 * kDegree));
}

TEST(HybridMapping, PullsTheWholeMapIntoTheOfflineFrameAtOnce) {
  HybridScene scene = true_hybrid_scene({});
  displace(scene.online, kDisplacement);
  const MapWindow whole = whole_map(scene.view());
  GlobalMappingOptions options;
  options.first_bundle_iterations = 20;
  apply_correction(adjust_map(MapWindow(whole), whole, {}, options), whole, scene.online);
  EXPECT_THAT(mean_error(scene).position, Lt(0.004));
}

// The newest keyframe alone, with its sightings of offline points.
HybridScene scene_of_one_keyframe() {
  HybridScene scene = true_hybrid_scene(without_noise());
  for (const PointId id : scene.online.point_ids()) scene.online.remove_point(id);
  Keyframe newest = *scene.online.find_keyframe(kLastKeyframe);
  newest.parent.reset();
  MapGraph alone(Origin::online);
  alone.add_rig(scene.second.rig);
  alone.add_keyframe(std::move(newest));
  scene.online = std::move(alone);
  return scene;
}

TEST(HybridMapping, TriangulatesBetweenANewAndAnOfflineKeyframe) {
  HybridScene scene = scene_of_one_keyframe();
  MappingOptions options;
  options.max_relative_depth_sigma = 0.3;  // corners without patches, 10 cm apart
  const std::vector<std::byte> before = bytes_of(scene.offline);
  const KeyframeId id = scene.online.keyframe_ids().front();
  apply(extend_map(cut_window(scene.view(), {id}, options.window), options), scene.online);
  EXPECT_THAT(scene.online.point_count(), Gt(20));
  for (const PointId point : scene.online.point_ids()) {
    EXPECT_THAT(scene.online.foreign_views(point).size(), Gt(0u));
    EXPECT_EQ(scene.online.find_point(point)->reference.keyframe, id);
    const int landmark = true_landmark(scene.second, scene.online, point);
    ASSERT_GE(landmark, 0);
    EXPECT_FALSE(is_known(landmark));
    EXPECT_THAT(scene.online.find_point(point)->position_in_world,
                PointNear(scene.second.landmarks_in_world[static_cast<std::size_t>(landmark)], 0.03));
  }
  EXPECT_THAT(find_faults(scene.online), IsEmpty());
  EXPECT_EQ(bytes_of(scene.offline), before);
}

// Number of online points of landmarks that the offline map has.
int count_known_online(const HybridScene& scene) {
  const std::vector<PointId> ids = scene.online.point_ids();
  return static_cast<int>(std::ranges::count_if(
      ids, [&](PointId id) { return scene.known_points.contains(true_landmark(scene.second, scene.online, id)); }));
}

int count_sightings_of_offline_points(const MapGraph& online) {
  int count = 0;
  for (const KeyframeId id : online.keyframe_ids()) {
    for (const Sighting& sighting : online.find_keyframe(id)->sightings) {
      count += sighting.point && sighting.point->origin == Origin::offline ? 1 : 0;
    }
  }
  return count;
}

// State after relocalisation: only the newest keyframe sees offline points.
HybridScene scene_with_duplicates() {
  HybridScene scene = two_true_maps({});
  const std::vector<Sighting> sightings = scene.online.find_keyframe(kLastKeyframe)->sightings;
  for (int feature = 0; feature < static_cast<int>(sightings.size()); ++feature) {
    const Observation seen{kLastKeyframe, feature};
    Sighting sighting = sightings[static_cast<std::size_t>(feature)];
    if (!sighting.point || feature % 2 == 0) continue;
    const auto known = scene.known_points.find(true_landmark(scene.second, scene.online, *sighting.point));
    if (known == scene.known_points.end()) continue;
    sighting.point = known->second;
    scene.online.remove_observation(seen);
    scene.online.add_observation(seen, sighting);
  }
  return scene;
}

TEST(HybridMapping, FusesOnlinePointsWithEqualOfflinePoints) {
  HybridScene scene = scene_with_duplicates();
  const int duplicates = count_known_online(scene);
  const int sightings = count_sightings_of_offline_points(scene.online);
  const std::vector<std::byte> before = bytes_of(scene.offline);
  MappingOptions options;
  options.redundant_share = 1.0;  // every keyframe stays
  for (int round = 0; round < 2; ++round) map_in_order(scene, options);
  EXPECT_THAT(duplicates, Gt(200));
  EXPECT_THAT(count_known_online(scene), Lt(0.2 * duplicates));
  EXPECT_THAT(count_sightings_of_offline_points(scene.online), Gt(5 * sightings));
  EXPECT_EQ(bytes_of(scene.offline), before);
  EXPECT_THAT(find_faults(scene.online), IsEmpty());
}

// Online points that match features of offline keyframes with an offline point of the same landmark.
TEST(HybridMapping, FusesPointsByObservationsOfOfflineKeyframes) {
  HybridScene scene = scene_with_duplicates();
  const MapWindow window = cut_window(scene.view(), {kLastKeyframe}, {});
  MapWindow fused = window;
  MappingOptions options;
  for (int i = 0; i < static_cast<int>(window.keyframes.size()); ++i) {
    if (is_offline(window.keyframes[static_cast<std::size_t>(i)])) fuse_between(fused, i, {0}, options);
  }
  const MapDelta delta = difference(window, fused);
  EXPECT_THAT(delta.removed_points.size(), Gt(20u));
  for (const OnlinePointId id : delta.removed_points) {
    EXPECT_TRUE(is_known(true_landmark(scene.second, scene.online, id)));
  }
}

TEST(HybridMapping, RemovesKeyframesWithFewOnlinePoints) {
  HybridScene scene = true_hybrid_scene({});
  const MapWindow window = cut_window(scene.view(), {kLastKeyframe}, {});
  for (const PointId id : scene.online.point_ids()) scene.online.remove_point(id);
  const MapWindow known = cut_window(scene.view(), {kLastKeyframe}, {});
  const auto removed = [](MapWindow thinned) {
    remove_redundant_keyframes(thinned, {});
    return std::ranges::count_if(thinned.keyframes, &WindowKeyframe::removed);
  };
  EXPECT_EQ(removed(known), MappingOptions{}.window.movable - 1) << "the newest stays";
  EXPECT_THAT(removed(window), Lt(removed(known)));
}

// Position error of the newest keyframe with wrong online anchors, metres.
double error_beside_wrong_anchors(double offline_weight, double offline_sigma) {
  HybridScene scene = true_hybrid_scene({});
  displace(scene.online, kDisplacement);
  for (const PointId id : scene.offline.point_ids()) {
    MapPoint point = *scene.offline.find_point(id);
    point.covariance = offline_sigma * offline_sigma * Eigen::Matrix3d::Identity();
    scene.offline.update_point(id, point);
  }
  MappingOptions options;
  options.window.movable = 1;
  options.offline_weight = offline_weight;
  apply(extend_map(cut_window(scene.view(), {kLastKeyframe}, options.window), options), scene.online);
  const Pose off = inverse(scene.online.camera_from_world(kLastKeyframe)) * scene.true_pose(kLastKeyframe);
  return off.translation.norm();
}

TEST(HybridMapping, FollowsOfflinePointsDespiteWrongAnchors) {
  constexpr double kAnchorSigma = 0.005;  // metres
  const double displacement = kDisplacement.translation.norm();
  EXPECT_THAT(error_beside_wrong_anchors(2.0, kAnchorSigma), Lt(0.2 * displacement));
  EXPECT_THAT(error_beside_wrong_anchors(8.0, kAnchorSigma), Lt(error_beside_wrong_anchors(0.125, kAnchorSigma)));
}

TEST(HybridMapping, WeightsOfflinePointsByTheirCovariance) {
  EXPECT_THAT(error_beside_wrong_anchors(2.0, 1.0), Gt(0.5 * kDisplacement.translation.norm()));
}

}  // namespace
}  // namespace byre
