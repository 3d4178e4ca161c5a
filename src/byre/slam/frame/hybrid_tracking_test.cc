#include "byre/slam/frame/hybrid_tracking.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/mission_scene.h"

#include <algorithm>
#include <iterator>
#include <random>
#include <utility>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr std::size_t kFrameTracked = 20;

Pose shift_by(double metres) {
  return {Eigen::Quaterniond::Identity(), {metres, 0.0, 0.0}};
}

// Moves a whole map in the world.
void move(MapGraph& map, const Pose& world_motion) {
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    map.move_keyframe(id, keyframe.camera_from_world * inverse(world_motion), keyframe.covariance);
  }
  for (const PointId id : map.point_ids()) {
    MapPoint point = *map.find_point(id);
    point.position_in_world = world_motion * point.position_in_world;
    map.update_point(id, point);
  }
}

// A room mapped in two visits.
class TrackHybrid : public ::testing::Test {
 protected:
  explicit TrackHybrid(int landmarks = SimulationOptions{}.landmarks) : landmarks_(landmarks) {}

  SimulationOptions visit(std::uint64_t noise_seed) const {
    SimulationOptions options;
    options.noise_seed = noise_seed;
    options.landmarks = landmarks_;
    options.max_features = landmarks_ / 2;
    return options;
  }

  std::optional<HybridTrack> track_frame() const { return track_frame(truth_); }
  std::optional<HybridTrack> track_frame(const Pose& predicted, const HybridLimits& limits = {}) const {
    std::vector<PointId> candidates = offline_.point_ids();
    const std::vector<PointId> online = online_.point_ids();
    candidates.insert(candidates.end(), online.begin(), online.end());
    return track_hybrid(now_.frames[kFrameTracked], predicted, now_.rig, {&offline_, online_}, candidates, {}, limits);
  }

  // Moves the offline points in this share of the image width, from the left.
  void move_left_part(double share_of_width, const Eigen::Vector3d& motion) {
    for (const PointId id : offline_.point_ids()) {
      MapPoint point = *offline_.find_point(id);
      const Eigen::Vector3d point_in_camera = truth_ * point.position_in_world;
      if (point_in_camera.z() <= 0.0) continue;
      if (now_.rig.project(point_in_camera).x() > share_of_width * now_.rig.width) continue;
      point.position_in_world += motion;
      offline_.update_point(id, point);
    }
  }

  // Changes the descriptors of all offline points but every count-th, as if they were occluded or looked different.
  void hide_but_each(std::uint32_t count) {
    std::mt19937_64 random(1);
    for (const PointId id : offline_.point_ids()) {
      if (id.number % count == 0) continue;
      MapPoint point = *offline_.find_point(id);
      for (std::uint64_t& bits : point.descriptor) bits = random();
      offline_.update_point(id, point);
    }
  }

  const int landmarks_;
  const SimulatedMission before_ = quarter_circle(visit(1));
  const SimulatedMission earlier_ = quarter_circle(visit(2));
  const SimulatedMission now_ = quarter_circle(visit(3));
  const Pose truth_ = true_camera_from_world(now_, kFrameTracked);
  MapGraph offline_ = true_map(before_, 4, Origin::offline);
  MapGraph online_ = true_map(earlier_, 4, Origin::online);
};

TEST(AgreementOf, ComparesCameraPositions) {
  const Pose camera_from_world = inverse({Eigen::Quaterniond::Identity(), {50.0, 10.0, 0.0}});
  const Pose turned_on_the_spot = Pose{rotation_exp({0.0, 0.01, 0.0}), Eigen::Vector3d::Zero()} * camera_from_world;
  const Agreement agreement = agreement_of(camera_from_world, turned_on_the_spot);
  EXPECT_NEAR(agreement.translation, 0.0, 1e-9);
  EXPECT_NEAR(agreement.rotation, 0.01, 1e-9);
  EXPECT_TRUE(is_within(agreement, {.translation = 0.01, .rotation = 0.02}));
  EXPECT_FALSE(is_within(agreement, {.translation = 0.01, .rotation = 0.005}));
}

TEST_F(TrackHybrid, UsesPointsOfBothMapsIfTheyAgree) {
  const auto track = track_frame();
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.01, 0.2 * kDegree));
  EXPECT_FALSE(track->maps_disagree);
  EXPECT_GT(track->offline_inliers, 50);
  EXPECT_EQ(track->offline_agreed.size(), static_cast<std::size_t>(track->offline_inliers));
  EXPECT_EQ(track->offline_reference->origin, Origin::offline);
}

TEST_F(TrackHybrid, FollowsTheOfflineMapDespiteADisplacedOnlineMap) {
  for (const double metres : {0.06, 0.2}) {
    MapGraph online = online_;
    move(online_, shift_by(metres));
    const Pose predicted = truth_ * inverse(shift_by(metres));  // predicted by the online map
    const auto track = track_frame(predicted);
    ASSERT_TRUE(track) << metres;
    EXPECT_TRUE(track->maps_disagree) << metres;
    EXPECT_TRUE(track->offline_prevails) << metres;
    EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.01, 0.2 * kDegree));
    EXPECT_GT(track->offline_inliers, 50) << metres;
    ASSERT_TRUE(track->from_online) << metres;
    EXPECT_THAT(inverse(*track->from_online).translation,
                PointNear((shift_by(metres) * inverse(truth_)).translation, 0.01));
    online_ = std::move(online);
  }
}

// On the return to the map the place of the online map has drifted.
TEST_F(TrackHybrid, IgnoresTheOnlineMapIfItsPlaceIsLessPreciseThanTheOfflinePose) {
  move(online_, shift_by(0.1));
  HybridLimits limits;
  limits.online_sigma = 0.1;
  const auto track = track_frame(truth_ * inverse(shift_by(0.1)), limits);
  ASSERT_TRUE(track);
  EXPECT_TRUE(track->maps_disagree && track->offline_prevails);
  EXPECT_FALSE(track->depends_on_online);
  EXPECT_EQ(track->tracked.camera_from_world.translation, track->from_offline->translation);
  EXPECT_NEAR(sigma_between_maps(*track), 0.1, 0.01);
}

TEST_F(TrackHybrid, DependsOnTheOnlineMapIfItsPlaceIsMorePrecise) {
  HybridLimits limits;
  limits.online_sigma = 1e-4;
  const auto track = track_frame(truth_, limits);
  ASSERT_TRUE(track);
  EXPECT_TRUE(track->offline_prevails);
  EXPECT_TRUE(track->depends_on_online);
  EXPECT_LT(sigma_between_maps(*track), 0.01);
}

TEST_F(TrackHybrid, StaysOnTheOnlineMapIfTheOffsetExceedsTheDrift) {
  move(online_, shift_by(0.4));
  const Pose predicted = truth_ * inverse(shift_by(0.4));
  const auto led_astray = track_frame(predicted, {.drift = {0.5, 0.1}});
  ASSERT_TRUE(led_astray);
  EXPECT_THAT(led_astray->tracked.camera_from_world, PoseNear(truth_, 0.01, 0.2 * kDegree));
  const auto track = track_frame(predicted, {.drift = {0.3, 0.1}});
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(predicted, 0.01, 0.2 * kDegree));
  EXPECT_FALSE(track->is_online_displaced());
}

TEST_F(TrackHybrid, IsLostIfOfflinePointsImplyAnImpossibleMotion) {
  online_ = MapGraph(Origin::online);
  const Pose predicted = truth_ * inverse(shift_by(0.4));
  EXPECT_TRUE(track_frame(predicted, {.stray = 0.5}));
  EXPECT_FALSE(track_frame(predicted, {.stray = 0.3}));
}

class TrackHybridInClutter : public TrackHybrid {
 protected:
  TrackHybridInClutter() : TrackHybrid(16000) {}
};

TEST_F(TrackHybridInClutter, FollowsTheOnlineMapIfFewOfflinePointsAgree) {
  hide_but_each(54);
  move(online_, shift_by(0.06));
  const Pose predicted = truth_ * inverse(shift_by(0.06));
  const auto track = track_frame(predicted);
  ASSERT_TRUE(track);
  ASSERT_TRUE(track->from_offline) << "they are enough for a pose";
  EXPECT_LT(track->offline_matches, 0.02 * track->offline_expected);
  EXPECT_TRUE(track->maps_disagree);
  EXPECT_FALSE(track->offline_prevails);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(predicted, 0.01, 0.2 * kDegree));
}

TEST_F(TrackHybrid, IsHardlyBiasedByALargeObjectMovedByTenCentimetres) {
  move_left_part(0.25, {0.09, 0.0, 0.06});
  const auto track = track_frame();
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.015, 0.3 * kDegree));
  EXPECT_GT(track->offline_inliers, 30) << "those that stayed are used";
  EXPECT_GT(track->offline_moved.size(), 10U);
}

// The corners of both parts of the image fit a pose between them within a pixel.
TEST_F(TrackHybrid, IsDoubtedIfTwoFifthsOfThePointsHaveMoved) {
  move_left_part(0.4, {0.09, 0.0, 0.06});
  const auto track = track_frame();
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.054, 1.5 * kDegree));
  EXPECT_TRUE(track->maps_disagree);
}

// A calibration error also causes a pixel or two, so points of both parts are used.
TEST_F(TrackHybrid, IsBiasedByLessThanHalfOfASmallMotionOfALargeObject) {
  for (const double share_of_width : {0.25, 0.4, 0.5}) {
    const MapGraph unchanged = offline_;
    move_left_part(share_of_width, {0.03, 0.0, 0.02});
    const auto track = track_frame();
    ASSERT_TRUE(track);
    EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.018, 0.5 * kDegree)) << share_of_width;
    offline_ = unchanged;
  }
}

TEST_F(TrackHybrid, ClassifiesGivenPointsAsAgreedOrMoved) {
  const std::vector<PointId> all = offline_.point_ids();
  std::vector<PointId> shelf;
  for (std::size_t i = 0; i < all.size(); i += 5) shelf.push_back(all[i]);
  const auto look = [&] {
    return search_points(now_.frames[kFrameTracked], truth_, now_.rig, {&offline_, online_}, shelf, {});
  };
  const SearchedPoints before = look();
  EXPECT_GT(before.agreed.size(), 10U);
  EXPECT_LT(before.moved.size(), before.agreed.size() / 4);
  for (const PointId id : shelf) {
    MapPoint point = *offline_.find_point(id);
    point.position_in_world.z() += 0.04;
    offline_.update_point(id, point);
  }
  const SearchedPoints after = look();
  EXPECT_GT(after.moved.size(), after.agreed.size());
  EXPECT_LT(after.agreed.size(), before.agreed.size() / 2);
}

TEST_F(TrackHybrid, ReportsMovedOfflinePoints) {
  const std::vector<PointId> all = offline_.point_ids();
  std::vector<PointId> shelf;  // a fifth of the points, raised by 4 cm
  for (std::size_t i = 0; i < all.size(); i += 5) shelf.push_back(all[i]);
  for (const PointId id : shelf) {
    MapPoint point = *offline_.find_point(id);
    point.position_in_world.z() += 0.04;
    offline_.update_point(id, point);
  }
  const auto track = track_frame();
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.01, 0.2 * kDegree));
  const auto count_shelf = [&](std::span<const PointId> points) {
    return std::ranges::count_if(points, [&](PointId id) { return std::ranges::binary_search(shelf, id); });
  };
  EXPECT_GT(count_shelf(track->offline_moved), 10);
  EXPECT_GT(count_shelf(track->offline_moved), 0.8 * static_cast<double>(track->offline_moved.size()));
}

TEST_F(TrackHybrid, TracksOnlinePointsAloneOffTheMap) {
  offline_ = MapGraph(Origin::offline);
  const auto track = track_frame();
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.01, 0.2 * kDegree));
  EXPECT_EQ(track->offline_expected, 0);
  EXPECT_EQ(track->offline_reference, std::nullopt);
  EXPECT_GT(track->online_inliers(), 50);
}

TEST_F(TrackHybrid, TracksOfflinePointsAloneWithoutAnOnlineMap) {
  online_ = MapGraph(Origin::online);
  const auto track = track_frame();
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(truth_, 0.01, 0.2 * kDegree));
  EXPECT_EQ(track->online_inliers(), 0);
  EXPECT_EQ(track->online_reference, std::nullopt);
}

TEST_F(TrackHybrid, FollowsTheOfflineMapInProportionToItsWeight) {
  move(online_, shift_by(0.005));  // too little to be detected as a disagreement
  // Half of the offline points, since features that match points of both maps are left to the offline one.
  std::vector<PointId> candidates = offline_.point_ids();
  std::erase_if(candidates, [](PointId id) { return id.number % 2 == 0; });
  std::ranges::copy(online_.point_ids(), std::back_inserter(candidates));
  std::vector<double> errors;
  for (const double weight : {0.2, 1.0, 20.0}) {
    TrackOptions options;
    options.offline_weight = weight;
    const auto track =
        track_hybrid(now_.frames[kFrameTracked], truth_, now_.rig, {&offline_, online_}, candidates, options);
    ASSERT_TRUE(track);
    EXPECT_GT(track->online_inliers(), 30);
    errors.push_back((inverse(track->tracked.camera_from_world).translation - inverse(truth_).translation).norm());
  }
  EXPECT_LT(errors[2], errors[0]);
}

TEST_F(TrackHybrid, IsEmptyInAnotherRoom) {
  SimulationOptions another_room;
  another_room.seed = 99;
  const SimulatedMission elsewhere = quarter_circle(another_room);
  const auto track =
      track_hybrid(elsewhere.frames[kFrameTracked], truth_, now_.rig, {&offline_, online_}, offline_.point_ids(), {});
  EXPECT_FALSE(track);
}

}  // namespace
}  // namespace byre
