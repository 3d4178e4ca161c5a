#include "byre/slam.h"

#include "byre/features/extract.h"
#include "byre/geometry/finite.h"
#include "byre/map/map_file.h"
#include "byre/map/map_graph.h"
#include "byre/slam/system/slam_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using std::chrono_literals::operator""ms;
using testing::HasSubstr;
using testing::SizeIs;

class SlamFileTest : public testing::Test {
 protected:
  SlamFileTest() { fs::remove(map_); }
  ~SlamFileTest() override { fs::remove(map_); }

  // Maps the shared recording into the file.
  void map_shared(std::size_t frames = 1000) const {
    Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
    std::vector<ImageFrame> seen = shared_frames();
    seen.resize(std::min(frames, seen.size()));
    causal(slam, seen);
    slam.finish();
    slam.save(map_);
  }

  const fs::path map_ = fs::path(testing::TempDir()) / ("byre_slam_test." + std::to_string(getpid()) + ".byre");
};

TEST(SlamOptions, ConfirmOrReplaceAnUnusualBaseline) {
  Calibration calibration = open_shared()->calibration();
  calibration.right->right_from_left.translation *= 7.5 / calibration.right->right_from_left.translation.norm();
  EXPECT_THAT(
      error_by([&] { Slam::mapping(calibration, repeatable()); }),
      testing::AllOf(testing::HasSubstr("baseline of 7.5 m"), testing::HasSubstr("SlamOptions::baseline = 7.5")));
  SlamOptions options = repeatable();
  options.baseline = 0.075;
  EXPECT_NEAR(Slam::mapping(calibration, options).rig().baseline, 0.075, 1e-9);
}

TEST_F(SlamFileTest, SavesTheRecordingOfAMap) {
  map_shared();
  const std::vector<ImageFrame> frames = shared_frames();
  const StoredMap kept = load_map(map_);
  EXPECT_GT(kept.map.point_count(), 100);
  ASSERT_THAT(kept.recordings, SizeIs(1));
  EXPECT_EQ(kept.recordings.front().name, "live");
  EXPECT_EQ(kept.recordings.front().first_time, frames.front().time);
  EXPECT_EQ(kept.recordings.front().last_time, frames.back().time);
  EXPECT_EQ(kept.recordings.front().calibration, open_shared()->calibration());
  EXPECT_EQ(kept.scale, MapScale::metric);
}

TEST_F(SlamFileTest, LocalisesAMissionOnAMap) {
  map_shared();
  Slam slam = Slam::on_map(open_shared()->calibration(), map_, repeatable());
  std::set<SessionEvent> events;
  FrameReport report;
  for (const ImageFrame& frame : shared_frames()) {
    report = slam.process(view_of(frame));
    events.insert(report.events.begin(), report.events.end());
  }
  EXPECT_TRUE(events.contains(SessionEvent::localised));
  EXPECT_EQ(report.health.verdict, Verdict::trusted) << to_string(report.health.doubt);
  ASSERT_TRUE(report.map_from_body);
  EXPECT_FALSE(slam.plan_from_body(*report.map_from_body)) << "the map is not registered";
  EXPECT_FALSE(slam.plan_covariance(*report.map_from_body, report.covariance));
  slam.finish();
  EXPECT_GT(slam.trajectory().size(), 10u);
}

// Overwrites a file in place, as a failing disk does.
void zero_in_place(const fs::path& file) {
  const std::string zeros(fs::file_size(file), '\0');
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary) << zeros;
}

void cut_in_place(const fs::path& file) {
  fs::resize_file(file, 1000);
}

TEST_F(SlamFileTest, ReportsDamageOfItsMapAndLosesNothing) {
  const std::vector<ImageFrame> frames = shared_frames();
  for (const auto damage : {zero_in_place, cut_in_place}) {
    for (const std::size_t good_frames : {0, 4}) {
      map_shared(8);
      Slam slam = Slam::on_map(open_shared()->calibration(), map_, repeatable());
      for (std::size_t i = 0; i < frames.size(); ++i) {
        if (i == good_frames) damage(map_);
        const bool was_damaged = slam.map_damage().has_value();  // a background search may detect the damage first
        const FrameReport report = slam.process(view_of(frames[i]));
        const bool is_damaged = report.health.doubt == DistrustReason::map_damaged;
        EXPECT_TRUE(is_damaged || !was_damaged) << i;
        EXPECT_TRUE(!is_damaged || report.health.verdict == Verdict::untrusted) << i;
      }
      if (good_frames == 0) {
        ASSERT_TRUE(slam.map_damage());
        EXPECT_THAT(*slam.map_damage(), HasSubstr(map_.string()));
      }
      slam.finish();
      fs::remove(map_);
      if (slam.keyframes() == 0) continue;
      slam.save(map_);
      EXPECT_GT(load_map(map_).map.keyframe_count(), 0);
    }
  }
}

TEST_F(SlamFileTest, DoesNotReplaceTheMapOfAMission) {
  map_shared(8);
  Slam slam = Slam::on_map(open_shared()->calibration(), map_, repeatable());
  causal(slam, shared_frames());
  ASSERT_GT(slam.keyframes(), 0);
  const auto time = fs::last_write_time(map_);
  EXPECT_THAT(error_by([&] { slam.save(map_); }), HasSubstr("is the offline map of the mission"));
  EXPECT_EQ(fs::last_write_time(map_), time);
  const fs::path letter = map_.string() + ".txt";
  std::ofstream(letter) << "Dear reader";
  EXPECT_THAT(error_by([&] { slam.save(letter); }), HasSubstr("exists and is not the expected kind of file (map)"));
  fs::remove(letter);
}

TEST_F(SlamFileTest, ExtendsAMap) {
  map_shared(8);
  const MapGraph before = load_map(map_).map;
  Slam slam = Slam::extending(open_shared()->calibration(), map_, repeatable());
  EXPECT_EQ(slam.keyframes(), before.keyframe_count());
  causal(slam, shared_frames());
  slam.finish();
  slam.save(map_);
  const StoredMap kept = load_map(map_);
  EXPECT_THAT(kept.recordings, SizeIs(2));
  EXPECT_GT(kept.map.keyframe_count(), before.keyframe_count());
  EXPECT_GT(slam.trajectory().size(), 10u);
}

TEST_F(SlamFileTest, LeavesAMapUnchangedWithoutLocalisation) {
  map_shared(8);
  Slam slam = Slam::extending(open_shared()->calibration(), map_, repeatable());
  ImageFrame dark = shared_frames().front();
  std::ranges::fill(dark.left.pixels, std::uint8_t{0});
  slam.process(view_of(dark));
  slam.finish();
  EXPECT_THAT(error_by([&] { slam.save(map_); }), HasSubstr("the map is still empty"));
}

TEST_F(SlamFileTest, SavesTheOnlineMapOfAMission) {
  map_shared(8);
  StoredMap on_plan = load_map(map_);
  on_plan.plan = PlanRegistration{"barn", {1.0, {Eigen::Quaterniond::Identity(), {10.0, 20.0, 0.0}}}};
  save_map(on_plan, map_);
  Slam slam = Slam::on_map(open_shared()->calibration(), map_, repeatable());
  const Trajectory poses = causal(slam, shared_frames());
  ASSERT_FALSE(poses.empty());
  const Eigen::Vector3d in_map = poses.back().world_from_body.translation;
  const Eigen::Vector3d on_floor = slam.plan_from_body(poses.back().world_from_body).value().translation;
  EXPECT_LT((on_floor - in_map - Eigen::Vector3d(10.0, 20.0, 0.0)).norm(), 1e-9);
  const Matrix6 in_doubt = slam.plan_covariance(poses.back().world_from_body, Matrix6::Identity()).value();
  EXPECT_LT((in_doubt - Matrix6::Identity()).norm(), 1e-12) << "the registration was given as exact";
  slam.finish();
  ASSERT_GT(slam.keyframes(), 0);
  EXPECT_EQ(slam.point_positions().size(), static_cast<std::size_t>(slam.points()));
  const auto greys = slam.point_greys();
  EXPECT_EQ(greys.size(), static_cast<std::size_t>(slam.points()));
  EXPECT_THAT(greys, testing::Contains(testing::Ne(std::nullopt)));
  EXPECT_THAT(greys, testing::Contains(testing::Ne(greys.front()))) << "texture";
  EXPECT_THROW(slam.save(map_), InputError) << "the mission reads it";
  const std::filesystem::path beside = std::filesystem::path(map_).concat("_beside.byre");
  slam.save(beside);
  const StoredMap kept = load_map(beside);
  std::filesystem::remove(beside);
  EXPECT_THAT(kept.recordings, SizeIs(1));
  EXPECT_FALSE(kept.plan) << "the registration is of the other map";
}

TEST_F(SlamFileTest, SavesItsMapInEveryState) {
  const std::vector<ImageFrame> frames = shared_frames();
  Slam slam = Slam::mapping(open_shared()->calibration());
  EXPECT_THAT(error_by([&] { slam.save(map_); }), HasSubstr("the map is still empty"));
  EXPECT_FALSE(fs::exists(map_));
  int keyframes_before = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    slam.process(view_of(frames[i]));
    if (i % 6 != 0) continue;
    slam.save(map_);
    const int keyframes = load_map(map_).map.keyframe_count();
    EXPECT_GE(keyframes, keyframes_before);
    keyframes_before = keyframes;
  }
  EXPECT_GT(keyframes_before, 0);
  slam.finish([] { return true; });
  slam.save(map_);
  EXPECT_GT(load_map(map_).map.keyframe_count(), 0);
}

TEST(Slam, RejectsInvalidCalibrations) {
  const Calibration sound = open_shared()->calibration();
  const auto error_with = [](const Calibration& calibration) { return error_by([&] { Slam::mapping(calibration); }); };
  Calibration unknown = sound;
  unknown.left.fx = unknown.left.fy = 0.0;
  EXPECT_THAT(error_with(unknown), HasSubstr("has an invalid camera"));
  Calibration both = sound;
  both.depth = DepthCamera{};
  EXPECT_THAT(error_with(both), HasSubstr("has both a right and a depth camera"));
  Calibration unitless = both;
  unitless.right.reset();
  unitless.depth->units_per_metre = 0.0;
  EXPECT_THAT(error_with(unitless), HasSubstr("has an invalid depth camera"));
}

TEST(Slam, RejectsUnreadableMaps) {
  EXPECT_THAT(error_by([] { Slam::on_map(open_shared()->calibration(), "no/such.byre"); }), HasSubstr("no/such.byre"));
  EXPECT_THAT(error_by([] { Slam::extending(open_shared()->calibration(), "no/such.byre"); }),
              HasSubstr("no/such.byre"));
  SlamOptions options;
  options.vocabulary = "no/such.vocabulary";
  EXPECT_THAT(error_by([&] { Slam::mapping(open_shared()->calibration(), options); }), HasSubstr("no/such.vocabulary"));
}

TEST(Slam, RejectsExtensionWithoutPlaceRecognition) {
  SlamOptions options;
  options.settings = {{"loops.close", "false"}};
  EXPECT_THAT(error_by([&] { Slam::extending(open_shared()->calibration(), "no/such.byre", options); }),
              HasSubstr("loops.close: is false, but a map is extended by place recognition"));
}

TEST(Slam, SetsOptionsByName) {
  const std::vector<ImageFrame> frames = shared_frames();
  SlamOptions options = repeatable();
  options.settings = {{"features.max_count", "150"}, {"tracking.search_radius_px", "20.5"}};
  Slam slam = Slam::mapping(open_shared()->calibration(), options);
  EXPECT_LE(slam.process(view_of(frames[0])).features, 150);
  options.settings = {{"features.max_counts", "150"}};
  EXPECT_THAT(
      error_by([&] { Slam::mapping(open_shared()->calibration(), options); }),
      HasSubstr("SlamOptions::settings: unknown option 'features.max_counts' (did you mean 'features.max_count'?)"));
  options.settings = {{"features.max_count", "nan"}};
  EXPECT_THAT(error_by([&] { Slam::mapping(open_shared()->calibration(), options); }),
              HasSubstr("(give from 1 to 100000, in corners)"));
}

TEST(Slam, DropsInvalidFramesAndContinues) {
  const std::vector<ImageFrame> frames = shared_frames();
  Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
  slam.process(view_of(frames[0]));
  slam.process(view_of(frames[1]));
  const FrameReport again = slam.process(view_of(frames[1]));
  EXPECT_EQ(again.input, InputFault::repeated_time);
  EXPECT_FALSE(again.map_from_body);
  EXPECT_EQ(again.state, State::tracking);
  EXPECT_EQ(again.health.verdict, Verdict::untrusted);
  EXPECT_EQ(slam.process(view_of(frames[0])).input, InputFault::out_of_order);
  EXPECT_EQ(slam.process(CameraImages{}).input, InputFault::no_image);
  const FrameReport next = slam.process(view_of(frames[2]));
  EXPECT_EQ(next.input, InputFault::none);
  EXPECT_TRUE(next.map_from_body);
  EXPECT_EQ(slam.frames(), 6);
  EXPECT_EQ(slam.frames(InputFault::none), 3);
  EXPECT_EQ(slam.frames(InputFault::out_of_order), 1);
  slam.finish();
  EXPECT_EQ(slam.process(view_of(frames[3])).input, InputFault::after_finishing);
  EXPECT_EQ(slam.process(Frame{}).input, InputFault::after_finishing);
}

TEST(Slam, TracksTheLeftImageIfTheRightOneIsUnusable) {
  const std::vector<ImageFrame> frames = shared_frames();
  Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
  for (std::size_t i = 0; i < 4; ++i) slam.process(view_of(frames[i]));
  CameraImages alone = view_of(frames[4]);
  alone.right.reset();
  const FrameReport without = slam.process(alone);
  EXPECT_EQ(without.input, InputFault::missing_right);
  EXPECT_TRUE(without.map_from_body);
  CameraImages late = view_of(frames[5]);
  late.right->time += std::chrono::milliseconds(20);
  const FrameReport unpaired = slam.process(late);
  EXPECT_EQ(unpaired.input, InputFault::late_right);
  EXPECT_TRUE(unpaired.map_from_body);
}

TEST(Slam, ReducesWorkForADeadlineAndReportsIt) {
  const std::vector<ImageFrame> frames = shared_frames();
  SlamOptions options = repeatable();
  options.settings.emplace_back("frame.deadline_ms", "0.001");
  Slam slam = Slam::mapping(open_shared()->calibration(), options);
  int with_left_alone = 0;
  for (const ImageFrame& frame : frames) {
    const FrameReport report = slam.process(view_of(frame));
    EXPECT_TRUE(report.map_from_body);
    EXPECT_TRUE(report.is_late);
    EXPECT_EQ(report.input, InputFault::none) << "the right image exists but is not used";
    with_left_alone += report.cuts.right_image ? 1 : 0;
  }
  EXPECT_GT(2 * with_left_alone, static_cast<int>(frames.size()));
}

TEST(Slam, GivesEqualResultsForEveryPixelFormat) {
  const std::vector<ImageFrame> frames = shared_frames();
  Slam grey = Slam::mapping(open_shared()->calibration(), repeatable());
  Slam colour = Slam::mapping(open_shared()->calibration(), repeatable());
  const auto bgr_of = [](const Image& image) {
    std::vector<std::uint8_t> bgr;
    for (const std::uint8_t value : image.pixels) bgr.insert(bgr.end(), 3, value);
    return bgr;
  };
  for (std::size_t i = 0; i < 6; ++i) {
    const std::vector<std::uint8_t> left = bgr_of(frames[i].left), right = bgr_of(*frames[i].right);
    CameraImages images = view_of(frames[i]);
    const FrameReport expected = grey.process(images);
    images.left.data = left.data();
    images.right->data = right.data();
    images.left.format = images.right->format = PixelFormat::bgr8;
    const FrameReport report = colour.process(images);
    ASSERT_TRUE(report.map_from_body);
    EXPECT_EQ(*report.map_from_body, *expected.map_from_body);
  }
}

TEST(Slam, HasNoMetricScaleWithOneCamera) {
  Calibration one = open_shared()->calibration();
  one.right.reset();
  EXPECT_FALSE(Slam::mapping(one).is_metric());
  EXPECT_EQ(Slam::mapping(one).rig().body_from_camera.translation, Eigen::Vector3d(Eigen::Vector3d::Zero()));
  EXPECT_TRUE(Slam::mapping(open_shared()->calibration()).is_metric());
}

TEST(Slam, TracksGivenFeaturesLikeItsOwn) {
  const Calibration calibration = open_shared()->calibration();
  Slam by_images = Slam::mapping(calibration, repeatable()), by_features = Slam::mapping(calibration, repeatable());
  Extractor extractor(calibration, {});
  for (const ImageFrame& frame : shared_frames()) {
    const FrameReport expected = by_images.process(view_of(frame));
    const FrameReport report = by_features.process(extractor.extract(frame).frame);
    EXPECT_EQ(report.map_from_body, expected.map_from_body);
  }
}

// Extreme and invalid values.
const std::vector<double>& hostile_values() {
  static const std::vector<double> values = {std::numeric_limits<double>::quiet_NaN(),
                                             std::numeric_limits<double>::infinity(),
                                             -std::numeric_limits<double>::infinity(),
                                             1.0001644e256,
                                             -1e308,
                                             std::numeric_limits<double>::max(),
                                             std::numeric_limits<double>::denorm_min(),
                                             0.0,
                                             -0.0,
                                             1e7};
  return values;
}

void expect_finite(const FrameReport& report) {
  EXPECT_TRUE(!report.map_from_body || is_finite(*report.map_from_body));
  EXPECT_TRUE(!report.odometry_from_body || is_finite(*report.odometry_from_body));
  EXPECT_TRUE(!report.correction || is_finite(*report.correction));
  EXPECT_TRUE(report.covariance.allFinite());
  EXPECT_TRUE(report.odometry_covariance.allFinite());
  const Health& health = report.health;
  for (const double value : {health.inlier_share, health.spread, health.position_sigma, health.rotation_sigma,
                             health.distance_since_offline, health.seconds_since_offline, health.focal_error}) {
    EXPECT_TRUE(std::isfinite(value));
  }
}

Pose hostile_pose(std::mt19937& random) {
  const auto value = [&] { return hostile_values()[random() % hostile_values().size()]; };
  Pose pose;
  pose.translation = {value(), random() % 2 == 0 ? value() : 0.0, 0.0};
  if (random() % 2 == 0) pose.rotation = Eigen::Quaterniond(value(), value(), 0.0, value());
  return pose;
}

// Adds samples of each motion input before a frame: valid or invalid, also with times out of order or range.
void feed_hostile(Slam& slam, Timestamp time, std::mt19937& random) {
  const auto value = [&] { return hostile_values()[random() % hostile_values().size()]; };
  const std::vector<Timestamp> times = {
      time,  time - std::chrono::hours(1),       time + std::chrono::hours(24), {}, Timestamp::max(), Timestamp::min(),
      -time, time - std::chrono::milliseconds(5)};
  for (int i = 0; i < 20; ++i) {
    const Timestamp at = random() % 2 == 0 ? time - std::chrono::milliseconds(20 - i) : times[random() % times.size()];
    const bool is_hostile = random() % 2 == 0;
    slam.add_wheel_odometry(StampedPose{at, is_hostile ? hostile_pose(random) : Pose{}});
    if (is_hostile) slam.add_wheel_odometry(BaseTwist{at, value(), value(), value()});
    slam.add_gyro({at, is_hostile ? Eigen::Vector3d(value(), value(), value()) : Eigen::Vector3d(0.0, 0.01, 0.1)});
    slam.add_accel({at, is_hostile ? Eigen::Vector3d(value(), value(), value()) : Eigen::Vector3d(0, 0, 9.8)});
  }
  slam.set_initial_pose({hostile_pose(random), value(), value(), value()});
}

std::optional<BodyMotion> hostile_motion(std::mt19937& random) {
  if (random() % 3 == 0) return {};
  BodyMotion motion(hostile_pose(random), Matrix6::Identity());
  if (random() % 2 == 0) motion.covariance(1, 1) = hostile_values()[random() % hostile_values().size()];
  return motion;
}

TEST_F(SlamFileTest, StaysFiniteWhateverMotionInputsReport) {
  map_shared();
  std::vector<ImageFrame> frames = shared_frames();
  for (std::size_t i = frames.size() / 3; i < frames.size() / 2; ++i) {  // measured motion bridges frames
    std::ranges::fill(frames[i].left.pixels, std::uint8_t{0});
    if (frames[i].right) std::ranges::fill(frames[i].right->pixels, std::uint8_t{0});
  }
  for (const bool is_mission : {true, false}) {
    for (const unsigned seed : {1U, 2U, 3U}) {
      std::mt19937 random(seed);
      Slam slam = is_mission ? Slam::on_map(open_shared()->calibration(), map_, repeatable())
                             : Slam::mapping(open_shared()->calibration(), repeatable());
      slam.set_gyro_extrinsics(Eigen::Quaterniond(0.0, 0.0, 0.0, seed == 1U ? 0.0 : hostile_values().front()));
      int poses = 0;
      for (const ImageFrame& frame : frames) {
        feed_hostile(slam, frame.time, random);
        const FrameReport report = slam.process(view_of(frame), hostile_motion(random));
        expect_finite(report);
        poses += report.map_from_body ? 1 : 0;
      }
      EXPECT_GE(poses, static_cast<int>(frames.size() / 3)) << "invalid samples lose no tracked pose";
      EXPECT_FALSE(slam.motion_warnings().empty());
      slam.finish();
      for (const StampedPose& pose : slam.trajectory()) EXPECT_TRUE(is_finite(pose.world_from_body));
      for (const Eigen::Vector3d& point : slam.point_positions()) EXPECT_TRUE(point.allFinite());
      if (slam.keyframes() == 0) continue;
      slam.save(map_.string() + ".hostile");
      EXPECT_TRUE(find_faults(load_map(map_.string() + ".hostile").map).empty());
      fs::remove(map_.string() + ".hostile");
    }
  }
}

TEST(Slam, ReportsEachFaultOfAMotionInputOnce) {
  const std::vector<ImageFrame> frames = shared_frames();
  Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
  std::vector<MotionWarning> warnings;
  for (const ImageFrame& frame : frames) {
    slam.add_gyro({frame.time, Eigen::Vector3d(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0)});
    const FrameReport report = slam.process(view_of(frame));
    warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
  }
  ASSERT_THAT(warnings, SizeIs(1));
  EXPECT_EQ(warnings.front().sensor, MotionSensor::gyroscope);
  EXPECT_EQ(warnings.front().time, frames.front().time);
  EXPECT_FALSE(warnings.front().remedy.empty());
  EXPECT_THAT(slam.motion_warnings(), SizeIs(1));
}

}  // namespace
}  // namespace byre
