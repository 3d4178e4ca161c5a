// Monocular mapping: a real recording from scratch, and a rendered rotation on the spot, which gives one camera no
// depth.

#include "mapped_recording.h"

#include "byre/features/extract.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/place/map_words.h"
#include "byre/place/vocabulary.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"
#include "byre/slam.h"
#include "byre/slam/system/slam_impl.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Gt;
using ::testing::Lt;

constexpr double kFrameRateHz = 20.0;
constexpr int kTurnFrames = 200;  // ten seconds

Calibration left_alone(Calibration calibration) {
  calibration.right.reset();
  return calibration;
}

Session session_of(const Rig& rig, std::shared_ptr<const OfflineMap> offline = nullptr) {
  return {rig,
          {},
          SessionExecutors(make_inline_executor(), make_inline_executor()),
          shipped_vocabulary(),
          std::move(offline)};
}

std::vector<bool> has_pose(const std::vector<FrameReport>& reports) {
  std::vector<bool> result;
  for (const FrameReport& report : reports) result.push_back(report.map_from_body.has_value());
  return result;
}

struct LeftCameraRun {
  std::vector<bool> has_pose;  // one element for each frame
  std::optional<AbsoluteTrajectoryError> error;
};

LeftCameraRun map_left_camera(const std::filesystem::path& folder, const OpenOptions& options,
                              const std::filesystem::path& truth_path) {
  const auto recording = open_recording(folder, {}, options);
  Calibration calibration = left_alone(recording->calibration());
  const Pose body_from_camera = std::exchange(calibration.body_from_left, {});  // poses are those of the camera
  Extractor extractor(calibration, {});
  Session session = session_of(extractor.rig());
  std::vector<FrameReport> reports;
  for (int i = 0; i < recording->size(); ++i) {
    reports.push_back(session.process(extractor.extract(recording->read(i).value()).frame));
  }
  session.finish();
  Trajectory truth = load_truth(truth_path);
  for (StampedPose& sample : truth) sample.world_from_body = sample.world_from_body * body_from_camera;
  return {has_pose(reports), absolute_trajectory_error(associate(session.final_trajectory(), truth, {}), Scale::free)};
}

TEST(OneCameraInMh01, StartsWithinTwoSecondsAndTracksEveryFrameToMillimetres) {
  const auto folder = find_recording("euroc/MH_01_easy");
  if (!folder) GTEST_SKIP() << missing("euroc/MH_01_easy");
  const auto [posed, error] = map_left_camera(*folder, {.camera = CameraChoice::left}, *folder);
  const auto first = std::ranges::find(posed, true);
  EXPECT_LE(static_cast<double>(first - posed.begin()) / kFrameRateHz, 2.0);
  EXPECT_EQ(std::count(first, posed.end(), false), 0);
  ASSERT_TRUE(error);
  EXPECT_LE(error->translation.rmse, 0.008);
}

// The calibration is the driver's default, 570 pixels without distortion. Turns against a tracking camera on the robot
// give 478 to 504 pixels.
TEST(OneCameraOnWheels, RefinesTheFocalLengthOfADriversDefault) {
  const auto folder = find_recording("wheeled/box");
  if (!folder) GTEST_SKIP() << missing("wheeled/box");
  const auto recording = open_recording(*folder, {});
  SlamOptions options;
  options.workers = Workers::repeatable;
  Slam slam = Slam::mapping(recording->calibration(), options);
  auto wheels = recording->motion().wheels.begin();
  for (int i = 0; i < recording->size(); ++i) {
    const std::optional<ImageFrame> images = recording->read(i);
    ASSERT_TRUE(images);
    for (; wheels != recording->motion().wheels.end() && wheels->time <= images->time; ++wheels) {
      slam.add_wheel_odometry(*wheels);
    }
    slam.process(view_of(*images));
  }
  slam.finish();
  EXPECT_THAT(slam.calibration().left.fx, AllOf(Gt(470.0), Lt(540.0)));
}

// A car enters a bend: the camera moves forward, most points are far, and the first view is soon lost.
TEST(OneCameraInBend, StartsInTheFirstFramesAndTracksEveryFrame) {
  const auto folder = find_recording("bend");
  if (!folder) GTEST_SKIP() << missing("bend");
  const auto [posed, error] = map_left_camera(*folder, {}, *folder / "truth.txt");
  const auto first = std::ranges::find(posed, true);
  EXPECT_LE(first - posed.begin(), 10);
  EXPECT_EQ(std::count(first, posed.end(), false), 0);
  ASSERT_TRUE(error);
  EXPECT_LE(error->translation.rmse, 0.1);
}

// The camera moves on unseen twice, for 3 and 2 s, and returns to the part of the desk that it mapped before.
TEST(OneCameraInFreiburg1Desk, MapsOnWhileLostAndJoinsNothingWrongly) {
  const auto folder = find_recording("tum/freiburg1_desk");
  if (!folder) GTEST_SKIP() << missing("tum/freiburg1_desk");
  const auto recording = open_recording(*folder, {}, {.camera = CameraChoice::left});
  SlamOptions options;
  options.workers = Workers::repeatable;
  Slam slam = Slam::mapping(recording->calibration(), options);
  std::size_t posed = 0;
  bool has_submap = false;
  for (int i = 0; i < recording->size(); ++i) {
    if ((i >= 150 && i < 240) || (i >= 361 && i < 421)) continue;
    const FrameReport report = slam.impl().process(*recording->read(i));
    posed += report.map_from_body ? 1 : 0;
    has_submap = has_submap || report.has(SessionEvent::restarted);
  }
  slam.impl().finish({[] { return false; }, {}});
  EXPECT_TRUE(has_submap);
  const Trajectory final = slam.impl().session().final_trajectory();
  EXPECT_GT(final.size() + slam.impl().session().frames_not_joined().size(), posed + 60) << "tracked while lost";
  const auto error = absolute_trajectory_error(associate(final, load_truth(*folder), {}), Scale::free);
  ASSERT_TRUE(error);
  EXPECT_LE(error->translation.rmse, 0.03);
}

// One turn about the left camera's centre in a rendered room. later_s shifts the times, so that no image of one turn
// equals one of another.
class TurnOnTheSpot : public testing::Test {
 protected:
  static Trajectory turn(double later_s) {
    Trajectory truth = turning_in_place_trajectory(kTurnFrames, kFrameRateHz, 1.0, kCalibration.body_from_left);
    for (StampedPose& sample : truth) sample.time += from_seconds(later_s);
    return truth;
  }

  static std::vector<FrameReport> run(Session& session, const Calibration& calibration, const Trajectory& truth) {
    Extractor extractor(calibration, {});
    const RenderedCameras cameras(calibration);
    std::vector<FrameReport> reports;
    for (const auto& [time, world_from_body] : truth) {
      const ImageFrame images = kRoom.render(cameras, world_from_body, time);
      reports.push_back(session.process(extractor.extract(images).frame));
    }
    return reports;
  }

  static Rig rig_of(const Calibration& calibration) { return Extractor(calibration, {}).rig(); }

  static inline const Calibration kCalibration = euroc_like_calibration(2);
  static inline const RenderedRoom kRoom{RenderedRoomOptions{}};
};

TEST_F(TurnOnTheSpot, StartsNoMapAndReportsWhy) {
  Session session = session_of(rig_of(left_alone(kCalibration)));
  const auto reports = run(session, left_alone(kCalibration), turn(0.0));
  EXPECT_THAT(has_pose(reports), Each(false));
  EXPECT_GT(std::ranges::count(reports, TwoViewFailure::rotation_only, &FrameReport::start_failure), kTurnFrames / 2);
}

// Monocular.TracksATurnOnTheSpotInAMap tests this on simulated features.
using LongRunTurnOnTheSpot = TurnOnTheSpot;

TEST_F(LongRunTurnOnTheSpot, IsTrackedFrameByFrameOnAStereoMap) {
  Session mapping = session_of(rig_of(kCalibration));
  run(mapping, kCalibration, turn(0.0));
  mapping.finish();
  StoredMap stored;
  stored.map = offline_copy(mapping.map().online());
  add_words(stored, shipped_vocabulary());
  Session mission = session_of(rig_of(left_alone(kCalibration)),
                               std::make_shared<const OfflineMap>(std::move(stored.map), shipped_vocabulary()));
  const Trajectory truth = turn(100.025);
  const auto reports = run(mission, left_alone(kCalibration), truth);
  EXPECT_THAT(has_pose(reports), Each(true));
  // The map's frame is the body frame of the first image.
  const Pose truth_from_map = turn(0.0).front().world_from_body;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (!reports[i].map_from_body) continue;
    const Pose estimated = truth_from_map * *reports[i].map_from_body;
    EXPECT_LT((estimated.translation - truth[i].world_from_body.translation).norm(), 0.03) << "frame " << i;
  }
}

}  // namespace
}  // namespace byre
