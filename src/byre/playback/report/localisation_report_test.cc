#include "byre/playback/report/localisation_report.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using nlohmann::json;
using testing::HasSubstr;

Pose at(double x) {
  return {Eigen::Quaterniond::Identity(), {x, 0.1 * x * x, 0.0}};
}

// Four keyframes; five frames: four localised, the last of them 1 m off, and one not.
StoredMap small_map() {
  StoredMap stored;
  stored.map.add_rig({});
  for (int i = 0; i < 4; ++i) {
    Keyframe keyframe;
    keyframe.frame.time = from_seconds(i);
    keyframe.camera_from_world = inverse(at(i));
    stored.map.add_keyframe(keyframe);
  }
  return stored;
}

LocaliseRun small_run() {
  LocaliseRun run;
  for (int i = 0; i < 5; ++i) {
    LocalisedFrame frame;
    frame.time = from_seconds(i + 0.5);
    if (i < 4) frame.world_from_body = at(i == 3 ? i + 1.5 : i + 0.5);
    frame.localisation.failure = i < 4 ? LocalisationFailure::none : LocalisationFailure::too_few_matches;
    run.frames.push_back(frame);
  }
  return run;
}

// True poses every 0.5 s, in a frame rotated and translated relative to the map's.
const Pose kPlanFromMap{rotation_exp({0.0, 0.0, 1.0}), {5.0, 6.0, 7.0}};

Trajectory truth_of_run() {
  Trajectory result;
  for (int i = 0; i < 11; ++i) result.push_back({from_seconds(0.5 * i), kPlanFromMap * at(0.5 * i)});
  return result;
}

TEST(ErrorsInMap, AlignTheMapByItsKeyframesOnly) {
  const LocalisationErrors errors = errors_in_map(small_run(), small_map(), truth_of_run(), truth_of_run());
  EXPECT_EQ(errors.alignment_keyframes, 4);
  ASSERT_EQ(errors.errors.size(), 4u);
  EXPECT_NEAR(errors.errors[0].position(), 0.0, 1e-9);
  EXPECT_NEAR(errors.errors[0].rotation(), 0.0, 1e-6);
  EXPECT_NEAR(errors.errors[3].position(), (at(4.5).translation - at(3.5).translation).norm(), 1e-9);
}

TEST(ErrorsInMap, UseUnalignedTruthThatDoesNotCoverTheMap) {
  const LocalisationErrors errors = errors_in_map(small_run(), small_map(), {}, truth_of_run());
  EXPECT_EQ(errors.alignment_keyframes, 0);
  EXPECT_GT(errors.errors[0].position(), 1.0);
}

TEST(LocaliseReport, CountsFoundFramesAndReasonsOfOthers) {
  const std::string text = localisation_report(small_run(), {"room.byre", "evening", 5}, std::nullopt).text;
  EXPECT_THAT(text, HasSubstr("found        4 of 5 frames (80.0 %)"));
  EXPECT_THAT(text, HasSubstr("not found    1: too few matches"));
}

TEST(LocaliseReport, CountsFramesThatAreFarOff) {
  const auto errors = errors_in_map(small_run(), small_map(), truth_of_run(), truth_of_run());
  EXPECT_THAT(localisation_report(small_run(), {}, errors).text,
              HasSubstr("far          1 accepted frames with an error above 0.5 m"));
  const json report = localisation_report(small_run(), {"room.byre", "evening", 5}, errors).figures;
  EXPECT_EQ(report.at("errors").at("frames_within_0.1m_2deg"), 3);
  EXPECT_EQ(report.at("errors").at("frames_off_by_more_than_0.5m"), 1);
  EXPECT_EQ(report.at("reasons").at("too few matches"), 1);
  EXPECT_EQ(report.at("per_frame").at(4).at("found"), false);
}

}  // namespace
}  // namespace byre
