#include "byre/slam/mapping/mapper.h"

#include "byre/base/job_slot_scene.h"
#include "byre/features/jpeg.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/places/place_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;

void run_jobs(Mapper& mapper) {
  for (JobState* const job : {&mapper.local_job(), &mapper.index_job(), &mapper.map_job()}) run_at_once(*job);
}

void finish(Mapper& mapper) {
  mapper.finish([&] { run_jobs(mapper); });
}

class MapperOfAMission : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = quarter_circle({});

  Mapper mapper(std::optional<Vocabulary> vocabulary = {}, std::shared_ptr<const OfflineMap> offline = nullptr) const {
    return {mission_.rig, {}, std::move(vocabulary), std::move(offline)};
  }
  Pose true_pose(std::size_t frame) const {  // in the map of the first frame
    return true_camera_from_world(mission_, frame) * mission_.truth[0].world_from_body;
  }
  // A frame tracked at its true pose on all points near the newest keyframe.
  HybridTrack track(const Mapper& mapper, std::size_t frame) const {
    const auto points = local_points(mapper.map(), *mapper.newest_keyframe(), 15);
    HybridTrack result;
    result.tracked =
        byre::track(mission_.frames[frame], true_pose(frame), mission_.rig, mapper.map(), points, {}).value();
    result.online_reference = result.tracked.reference;
    return result;
  }
};

TEST_F(MapperOfAMission, StartsWithAStereoFrame) {
  Mapper mapper = this->mapper();
  EXPECT_FALSE(mapper.newest_keyframe());
  const Mapper::Beginning begun = mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  ASSERT_EQ(begun.keyframes.size(), 1u);
  EXPECT_EQ(mapper.newest_keyframe(), begun.keyframes[0]);
  EXPECT_TRUE(mapper.submaps().is_registered());
  EXPECT_GT(mapper.online().point_count(), 100);
}

TEST_F(MapperOfAMission, DoesNotStartWithAnEmptyFrame) {
  Mapper mapper = this->mapper();
  const Frame blank{mission_.frames[0].time, std::make_shared<const Features>()};
  EXPECT_THAT(mapper.begin(blank, mission_.rig, {}, AnchoredTrajectory({})).keyframes, IsEmpty());
  EXPECT_TRUE(mapper.submaps().empty());
  EXPECT_EQ(mapper.revision(), 0);
}

TEST_F(MapperOfAMission, ChangesItsRevisionWithTheMap) {
  Mapper mapper = this->mapper();
  mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  const int begun = mapper.revision();
  mapper.add_keyframe(mission_.frames[4], track(mapper, 4), mission_.rig);
  const int added = mapper.revision();
  EXPECT_GT(added, begun);
  EXPECT_EQ(mapper.pending(), 0) << "the job has the keyframe";
  EXPECT_FALSE(mapper.collect());
  EXPECT_EQ(mapper.revision(), added);
  run_jobs(mapper);
  EXPECT_TRUE(mapper.collect());
  EXPECT_GT(mapper.revision(), added);
  EXPECT_THAT(find_faults(mapper.online()), IsEmpty());
}

// A third of the features loses its disparity and hence gives no point from a single frame.
Frame with_patches(const Frame& frame, const Rig& rig) {
  const Features& bare = *frame.features;
  std::vector<Keypoint> keypoints = to_vector(bare.keypoints());
  for (std::size_t i = 0; i < keypoints.size(); i += 3) keypoints[i].disparity = keypoints[i].disparity_sigma = -1.0f;
  Frame result = frame;
  result.features =
      std::make_shared<const Features>(rig.width, rig.height, std::move(keypoints), to_vector(bare.descriptors()),
                                       std::vector<Patch>(static_cast<std::size_t>(bare.size())));
  return result;
}

TEST_F(MapperOfAMission, DropsUnusedPatchesAfterThirtyTwoKeyframes) {
  Mapper mapper = this->mapper();
  const KeyframeId first =
      mapper.begin(with_patches(mission_.frames[0], mission_.rig), mission_.rig, {}, AnchoredTrajectory({}))
          .keyframes.front();
  const auto patches_without_point = [&] {
    const Keyframe& keyframe = *mapper.online().find_keyframe(first);
    int count = 0;
    for (int i = 0; i < keyframe.frame.features->size(); ++i) {
      const bool sees_point = keyframe.sightings[static_cast<std::size_t>(i)].point.has_value();
      const bool has_patch = keyframe.frame.features->find_patch(i) != nullptr;
      EXPECT_TRUE(has_patch || !sees_point) << "feature " << i;
      count += has_patch && !sees_point ? 1 : 0;
    }
    return count;
  };
  for (std::size_t frame = 1; frame < 32; ++frame) {
    mapper.add_keyframe(mission_.frames[frame], track(mapper, frame), mission_.rig);
  }
  EXPECT_GT(patches_without_point(), 0);
  mapper.add_keyframe(mission_.frames[32], track(mapper, 32), mission_.rig);
  EXPECT_EQ(patches_without_point(), 0);
}

TEST_F(MapperOfAMission, StoresTheFeaturesOfOlderKeyframesInAFile) {
  Mapper mapper = this->mapper();
  const KeyframeId first =
      mapper.begin(with_patches(mission_.frames[0], mission_.rig), mission_.rig, {}, AnchoredTrajectory({}))
          .keyframes.front();
  const auto features = [&] { return mapper.online().find_keyframe(first)->frame.features; };
  for (std::size_t frame = 1; frame < 33; ++frame) {
    mapper.add_keyframe(mission_.frames[frame], track(mapper, frame), mission_.rig);
    run_jobs(mapper);
    mapper.collect();
  }
  const std::shared_ptr<const Features> in_memory = features();
  mapper.add_keyframe(mission_.frames[33], track(mapper, 33), mission_.rig);
  run_jobs(mapper);
  EXPECT_EQ(features(), in_memory) << "the result of the job is not applied yet";
  mapper.collect();
  const auto before = in_memory->arrays(), paged = features()->arrays();
  for (std::size_t i = 0; i < Features::kArrays; ++i) {
    EXPECT_FALSE(paged[i].empty());
    EXPECT_NE(paged[i].data(), before[i].data()) << i;
    EXPECT_TRUE(std::ranges::equal(paged[i], before[i])) << i;
  }
}

TEST_F(MapperOfAMission, EncodesPicturesOfKeyframesInAJob) {
  Mapper mapper = this->mapper();
  const auto with_picture = [&](std::size_t number) {
    Frame frame = mission_.frames[number];
    const auto grey = static_cast<std::uint8_t>(60 + 10 * number);
    frame.picture = std::make_shared<const Image>(Image{32, 16, std::vector<std::uint8_t>(512, grey)});
    return frame;
  };
  const KeyframeId first = mapper.begin(with_picture(0), mission_.rig, {}, AnchoredTrajectory({})).keyframes.front();
  const KeyframeId second = mapper.add_keyframe(with_picture(4), track(mapper, 4), mission_.rig);
  EXPECT_FALSE(mapper.online().find_keyframe(second)->picture);
  run_jobs(mapper);
  mapper.collect();
  for (const auto& [id, grey] : {std::pair(first, 60), std::pair(second, 100)}) {
    const Keyframe& keyframe = *mapper.online().find_keyframe(id);
    EXPECT_FALSE(keyframe.frame.picture);
    const std::optional<Image> decoded = decode_jpeg(keyframe.picture.jpeg());
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->width, 32);
    EXPECT_NEAR(decoded->pixels.front(), grey, 2);
  }
  const KeyframeId third = mapper.add_keyframe(mission_.frames[8], track(mapper, 8), mission_.rig);
  run_jobs(mapper);
  mapper.collect();
  EXPECT_FALSE(mapper.online().find_keyframe(third)->picture);
}

TEST_F(MapperOfAMission, KeepsKeyframesPendingWhileAJobRuns) {
  Mapper mapper = this->mapper();
  mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  mapper.add_keyframe(mission_.frames[4], track(mapper, 4), mission_.rig);
  mapper.add_keyframe(mission_.frames[8], track(mapper, 8), mission_.rig);
  EXPECT_EQ(mapper.pending(), 1);
  finish(mapper);
  EXPECT_EQ(mapper.pending(), 0);
}

TEST_F(MapperOfAMission, HasTheWordsOfAKeyframeAfterAJob) {
  Mapper mapper = this->mapper(simulated_vocabulary());
  const auto words_of = [&](KeyframeId id) { return mapper.online().find_keyframe(id)->words.size(); };
  const Mapper::Beginning begun = mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  EXPECT_GT(words_of(begun.keyframes[0]), 0u) << "at once, for relocalisation";
  const KeyframeId id = mapper.add_keyframe(mission_.frames[4], track(mapper, 4), mission_.rig);
  mapper.request_jobs();
  run_at_once(mapper.index_job());
  EXPECT_EQ(words_of(id), 0u) << "the result is not applied yet";
  mapper.collect();
  EXPECT_EQ(words_of(id), static_cast<std::size_t>(mission_.frames[4].features->size()));
  EXPECT_EQ(mapper.places()->size(), 2);
  mapper.request_jobs();
  EXPECT_TRUE(mapper.index_job().is_idle()) << "no index is needed";
}

// Jobs read a snapshot, so the map may change meanwhile.
TEST_F(MapperOfAMission, IndexesKeyframesAddedWhileAJobRuns) {
  Mapper mapper = this->mapper(simulated_vocabulary());
  mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  mapper.add_keyframe(mission_.frames[4], track(mapper, 4), mission_.rig);
  mapper.request_jobs();
  const std::optional<Job> job = mapper.index_job().take_request();
  ASSERT_TRUE(job);
  std::vector<KeyframeId> meanwhile;
  for (const std::size_t frame : {8u, 12u}) {
    meanwhile.push_back(mapper.add_keyframe(mission_.frames[frame], track(mapper, frame), mission_.rig));
    mapper.request_jobs();
    EXPECT_FALSE(mapper.index_job().take_request()) << "one job at a time";
  }
  mapper.index_job().deliver({(*job)(), 0.0});
  mapper.collect();
  mapper.request_jobs();
  run_at_once(mapper.index_job());
  mapper.collect();
  for (const KeyframeId id : meanwhile) EXPECT_FALSE(mapper.online().find_keyframe(id)->words.empty());
  EXPECT_EQ(mapper.places()->size(), 4);
}

TEST_F(MapperOfAMission, IndexesRemainingKeyframesAtTheEnd) {
  Mapper mapper = this->mapper(simulated_vocabulary());
  mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  const KeyframeId id = mapper.add_keyframe(mission_.frames[4], track(mapper, 4), mission_.rig);
  finish(mapper);
  EXPECT_FALSE(mapper.online().find_keyframe(id)->words.empty());
  EXPECT_EQ(mapper.places()->size(), 2);
}

TEST_F(MapperOfAMission, HasIndependentCopies) {
  Mapper mapper = this->mapper();
  mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  const Mapper before = mapper;
  const int points = before.online().point_count();
  mapper.add_keyframe(mission_.frames[4], track(mapper, 4), mission_.rig);
  finish(mapper);
  EXPECT_EQ(before.online().keyframe_count(), 1);
  EXPECT_EQ(before.online().point_count(), points);
  EXPECT_THAT(find_faults(before.online()), IsEmpty());
  EXPECT_EQ(mapper.online().keyframe_count(), 2);
}

TEST_F(MapperOfAMission, AppliesACorrectionOnceNoJobRuns) {
  Mapper mapper = this->mapper(simulated_vocabulary(), offline_map_of(mission_));
  mapper.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({}));
  EXPECT_FALSE(mapper.submaps().is_registered()) << "its pose in the map is unknown";
  const KeyframeId id = mapper.add_keyframe(mission_.frames[4], track(mapper, 4), mission_.rig);
  const Pose offline_from_online{rotation_exp({0.0, 0.0, 0.4}), {1.0, 2.0, 0.0}};
  mapper.correct_later({mapper.submaps().frame(), 0, offline_from_online, CorrectionShape::rigid});
  EXPECT_TRUE(mapper.has_correction());
  EXPECT_FALSE(mapper.correct_online()) << "a job uses the keyframes to be moved";
  run_jobs(mapper);
  mapper.collect();
  const Pose before = mapper.online().camera_from_world(id);
  EXPECT_TRUE(mapper.correct_online());
  EXPECT_FALSE(mapper.has_correction());
  EXPECT_TRUE(mapper.submaps().is_registered());
  EXPECT_THAT(mapper.online().camera_from_world(id), PoseNear(before * inverse(offline_from_online), 1e-9, 1e-9));
}

SimulatedMission one_camera_circling(int frames, double laps) {
  Rig rig = simulated_rig();
  rig.baseline = 0.0;
  SimulationOptions options;
  options.landmarks = 8000;
  options.noise_seed = 2;
  return simulate_mission(rig, circling_trajectory(frames, 10.0, 2.0, laps), options);
}

TEST(MapperOfOneCamera, StartsOneMap) {
  const SimulatedMission mission = one_camera_circling(120, 1.0);
  const Rig& rig = mission.rig;
  Mapper mapper(rig, {});
  EXPECT_TRUE(mapper.can_begin(rig));
  std::size_t frame = 0;
  Mapper::Beginning begun;
  while (begun.keyframes.empty() && frame < mission.frames.size()) {
    begun = mapper.begin(mission.frames[frame++], rig, {}, AnchoredTrajectory({}));
  }
  ASSERT_EQ(begun.keyframes.size(), 2u);
  EXPECT_EQ(mapper.newest_keyframe(), begun.keyframes[1]);
  EXPECT_EQ(mapper.pending(), 1) << "its points wait for mapping";
  EXPECT_FALSE(mapper.can_begin(rig));
}

// With odometry, a monocular map begins at the predicted pose and in the lengths of the odometry.
TEST(MapperOfOneCamera, StartsAtTheGivenPose) {
  const SimulatedMission mission = one_camera_circling(60, 0.5);
  const Rig& rig = mission.rig;
  const Pose world_from_truth{rotation_exp({0.0, 0.0, 2.0}), {1.0, 2.0, 3.0}};
  Mapper mapper(rig, {});
  std::size_t frame = 0;
  Mapper::Beginning begun;
  Pose measured;
  while (begun.keyframes.empty() && frame < mission.frames.size()) {
    measured = inverse(world_from_truth * mission.truth[frame].world_from_body);
    begun = mapper.begin(mission.frames[frame++], rig, measured, AnchoredTrajectory({}));
  }
  ASSERT_EQ(begun.keyframes.size(), 2u);
  const MapGraph& map = mapper.online();
  EXPECT_THAT(map.camera_from_world(begun.keyframes[1]), PoseNear(measured, 1e-9, 1e-9));
  const Timestamp first_time = map.find_keyframe(begun.keyframes[0])->frame.time;
  const auto first = std::ranges::find(mission.truth, first_time, &StampedPose::time);
  const double way = (first->world_from_body.translation - mission.truth[frame - 1].world_from_body.translation).norm();
  const Pose seen = map.camera_from_world(begun.keyframes[0]) * inverse(map.camera_from_world(begun.keyframes[1]));
  EXPECT_NEAR(seen.translation.norm(), way, 1e-9);
  const auto faults = find_faults(map);
  EXPECT_TRUE(faults.empty()) << faults.front();
}

}  // namespace
}  // namespace byre
