#include "byre/slam/places/localisation.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/places/place_scene.h"

#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

SimulationOptions visit(std::uint64_t noise_seed) {
  SimulationOptions options;
  options.noise_seed = noise_seed;
  return options;
}

SimulatedMission lap(const SimulationOptions& options, double radius_m = 2.0, const Rig& rig = simulated_rig()) {
  return simulate_mission(rig, circling_trajectory(60, 10.0, radius_m, 1.0), options);
}

// Made once, for all tests to read.
const MappedPlace& mapped() {
  static const MappedPlace place(lap(visit(1)));
  return place;
}

Localisation localise_in(const MappedPlace& place, const Frame& frame, const Rig& rig) {
  return localise(frame, rig, place.view(), place.index, {});
}

// Frame with the features for which choose(index) is true.
Frame chosen(const Frame& frame, const Rig& rig, const std::function<bool(int)>& choose) {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < frame.features->size(); ++i) {
    if (!choose(i)) continue;
    keypoints.push_back(frame.features->keypoint(i));
    descriptors.push_back(frame.features->descriptor(i));
  }
  return {frame.time, std::make_shared<Features>(rig.width, rig.height, keypoints, descriptors, std::vector<Patch>{})};
}

TEST(Localise, LocatesEveryFrameOfAnotherVisit) {
  const SimulatedMission later = lap(visit(2), 1.8);
  for (std::size_t i = 0; i < later.frames.size(); i += 3) {
    const Localisation found = localise_in(mapped(), later.frames[i], later.rig);
    ASSERT_TRUE(found.tracked) << "frame " << i << ": " << to_string(found.failure);
    EXPECT_THAT(found.tracked->camera_from_world, PoseNear(true_camera_from_world(later, i), 0.02, 0.01));
    EXPECT_EQ(found.failure, LocalisationFailure::none);
  }
}

TEST(Localise, LocatesFramesOfASingleCamera) {
  Rig rig = simulated_rig();
  rig.baseline = 0.0;
  const SimulatedMission later = lap(visit(3), 2.1, rig);
  for (std::size_t i = 0; i < later.frames.size(); i += 6) {
    const Localisation found = localise_in(mapped(), later.frames[i], rig);
    ASSERT_TRUE(found.tracked) << "frame " << i << ": " << to_string(found.failure);
    EXPECT_THAT(found.tracked->camera_from_world, PoseNear(true_camera_from_world(later, i), 0.05, 0.02));
  }
}

TEST(Localise, ReturnsACovarianceThatCoversItsError) {
  const SimulatedMission later = lap(visit(4));
  int within = 0, found_count = 0;
  for (std::size_t i = 0; i < later.frames.size(); ++i) {
    const Localisation found = localise_in(mapped(), later.frames[i], later.rig);
    if (!found.tracked) continue;
    ++found_count;
    const Vector6 error = log_pose(true_camera_from_world(later, i) * inverse(found.tracked->camera_from_world));
    within += error.dot(found.tracked->covariance.ldlt().solve(error)) < 12.592;  // 95 %, six degrees of freedom
  }
  EXPECT_EQ(found_count, 60);
  EXPECT_GE(within, 50);
}

TEST(Localise, RejectsAnotherRoom) {
  SimulationOptions elsewhere = visit(1);
  elsewhere.seed = 77;
  const SimulatedMission other = lap(elsewhere);
  for (std::size_t i = 0; i < other.frames.size(); i += 6) {
    const Localisation result = localise_in(mapped(), other.frames[i], other.rig);
    EXPECT_FALSE(result.tracked) << "frame " << i;
    EXPECT_NE(result.failure, LocalisationFailure::none);
  }
}

TEST(Localise, ReportsTooFewFeatures) {
  const SimulatedMission later = lap(visit(5));
  const Frame nearly_blank = chosen(later.frames[0], later.rig, [](int i) { return i < 20; });
  EXPECT_EQ(localise_in(mapped(), nearly_blank, later.rig).failure, LocalisationFailure::too_few_features);
}

TEST(Localise, ReportsNoSimilarKeyframe) {
  const SimulatedMission later = lap(visit(5));
  const PlaceIndex empty(mapped().index.vocabulary());
  const Localisation result = localise(later.frames[0], later.rig, mapped().view(), empty, {});
  EXPECT_EQ(result.failure, LocalisationFailure::no_similar_keyframe);
  EXPECT_EQ(result.places, 0);
}

TEST(Localise, RejectsClusteredInliers) {
  const SimulatedMission later = lap(visit(6));
  const Frame corner = chosen(later.frames[0], later.rig, [&](int i) {
    const Keypoint& keypoint = later.frames[0].features->keypoint(i);
    return keypoint.pixel.x() < 0.35f * static_cast<float>(later.rig.width);
  });
  LocaliseOptions options;
  options.max_position_sigma = options.max_rotation_sigma = 10.0;
  options.min_spread = 0.2;
  const Localisation result = localise(corner, later.rig, mapped().view(), mapped().index, options);
  EXPECT_EQ(result.failure, LocalisationFailure::clustered);
  EXPECT_GE(result.inliers, options.min_inliers);
}

TEST(Localise, RejectsAnUncertainPose) {
  const SimulatedMission later = lap(visit(7));
  LocaliseOptions options;
  options.max_position_sigma = 1e-6;
  const Localisation result = localise(later.frames[0], later.rig, mapped().view(), mapped().index, options);
  EXPECT_EQ(result.failure, LocalisationFailure::uncertain);
}

TEST(Localise, ReportsTwoAmbiguousPlaces) {
  const MappedPlace place = twin_rooms(lap(visit(1)));
  ASSERT_THAT(find_faults(place.map), testing::IsEmpty());
  const SimulatedMission later = lap(visit(8));
  for (std::size_t i = 0; i < later.frames.size(); i += 10) {
    const Localisation result = localise_in(place, later.frames[i], later.rig);
    EXPECT_FALSE(result.tracked) << "frame " << i;
    EXPECT_EQ(result.failure, LocalisationFailure::ambiguous) << "frame " << i << ": " << to_string(result.failure);
    EXPECT_EQ(result.places_found.size(), 2u) << "frame " << i;
  }
}

TEST(Localise, SelectsThePlaceOfTheTagInTwinRooms) {
  const MappedPlace place = twin_rooms(lap(visit(1)));
  const SimulatedMission later = lap(visit(8));
  const Pose shift{Eigen::Quaterniond::Identity(), {10.0, 0.0, 0.0}};
  for (std::size_t i = 0; i < later.frames.size(); i += 10) {
    const Pose camera = true_camera_from_world(later, i);
    MappedTag tag = tag_before(camera);
    const Frame frame = with_tag(later.frames[i], tag, camera, later.rig);
    ASSERT_EQ(frame.tags.size(), 1U);
    for (const Pose& room : {Pose{}, shift}) {
      MappedTag in_room = tag;
      in_room.map_from_tag = room * tag.map_from_tag;
      LocaliseOptions options;
      options.tags = std::span(&in_room, 1);
      const Localisation found = localise(frame, later.rig, place.view(), place.index, options);
      ASSERT_TRUE(found.tracked) << "frame " << i << ": " << to_string(found.failure);
      EXPECT_THAT(found.tracked->camera_from_world, PoseNear(camera * inverse(room), 0.03, 0.01)) << "frame " << i;
      EXPECT_EQ(found.places_found.size(), 2U) << "the other room remains a rival";
    }
  }
}

TEST(Localise, LocalisesByATagWithoutSimilarKeyframes) {
  const SimulatedMission later = lap(visit(8));
  const Pose camera = true_camera_from_world(later, 3);
  const MappedTag tag = tag_before(camera);
  const PlaceIndex empty(mapped().index.vocabulary());
  LocaliseOptions options;
  options.tags = std::span(&tag, 1);
  const Frame frame = with_tag(later.frames[3], tag, camera, later.rig);
  const Localisation found = localise(frame, later.rig, mapped().view(), empty, options);
  ASSERT_TRUE(found.tracked) << to_string(found.failure);
  EXPECT_THAT(found.tracked->camera_from_world, PoseNear(camera, 0.02, 0.01));
}

TEST(Localise, IsNotMisledByAMovedTag) {
  const SimulatedMission later = lap(visit(8));
  const Pose camera = true_camera_from_world(later, 3);
  MappedTag tag = tag_before(camera);
  const Frame frame = with_tag(later.frames[3], tag, camera, later.rig);
  tag.map_from_tag = Pose{rotation_exp({0.0, 0.0, 1.0}), {1.5, 0.5, 0.0}} * tag.map_from_tag;
  LocaliseOptions options;
  options.tags = std::span(&tag, 1);
  const Localisation found = localise(frame, later.rig, mapped().view(), mapped().index, options);
  ASSERT_TRUE(found.tracked) << to_string(found.failure);
  EXPECT_THAT(found.tracked->camera_from_world, PoseNear(camera, 0.02, 0.01));
}

TEST(Localise, IsDeterministic) {
  const SimulatedMission later = lap(visit(9));
  const Localisation first = localise_in(mapped(), later.frames[5], later.rig);
  const Localisation second = localise_in(mapped(), later.frames[5], later.rig);
  ASSERT_TRUE(first.tracked && second.tracked);
  EXPECT_EQ(first.tracked->camera_from_world.translation, second.tracked->camera_from_world.translation);
  EXPECT_EQ(first.inliers, second.inliers);
}

TEST(MatchPlace, MatchesMostlyTruePoints) {
  const SimulatedMission mission = lap(visit(1)), later = lap(visit(2));
  const auto words = mapped().index.vocabulary().words_of(*later.frames[0].features);
  const std::vector<KeyframeId> keyframes = {{Origin::offline, 0}, {Origin::offline, 1}};
  const auto matches = match_place(*later.frames[0].features, words, mapped().view(), keyframes,
                                   mapped().index.vocabulary(), {.levels_up = 2});
  int right = 0;
  std::set<int> features;
  std::set<PointId> points;
  for (const PointMatch& match : matches) {
    const int landmark = later.landmark_of_feature[0][static_cast<std::size_t>(match.feature)];
    right += landmark >= 0 && landmark == true_landmark(mission, mapped().map, match.point);
    features.insert(match.feature);
    points.insert(match.point);
  }
  EXPECT_GE(matches.size(), 100u);
  EXPECT_GE(right, static_cast<int>(0.95 * static_cast<double>(matches.size())));
  EXPECT_EQ(features.size(), matches.size());
  EXPECT_EQ(points.size(), matches.size());
}

TEST(MatchPlace, MatchesMorePointsWithoutWords) {
  const SimulatedMission later = lap(visit(2));
  const Vocabulary& vocabulary = mapped().index.vocabulary();
  const auto words = vocabulary.words_of(*later.frames[0].features);
  const std::vector<KeyframeId> keyframes = {{Origin::offline, 0}};
  const auto count = [&](int levels_up) {
    return match_place(*later.frames[0].features, words, mapped().view(), keyframes, vocabulary,
                       {.levels_up = levels_up})
        .size();
  };
  EXPECT_GE(count(3), count(2));
  EXPECT_GE(count(2), count(0));
}

TEST(LocalisationFailure, HasANameForEachReason) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(LocalisationFailure::ambiguous); ++i) {
    names.insert(to_string(static_cast<LocalisationFailure>(i)));
  }
  EXPECT_EQ(names.size(), 11u);
  EXPECT_FALSE(names.contains(""));
}

}  // namespace
}  // namespace byre
