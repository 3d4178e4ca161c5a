#include "byre/simulation/cowshed/cowshed_recording.h"

#include "byre/base/sanitizer_scene.h"
#include "byre/base/text_file.h"
#include "byre/calibration_file.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/image_condition.h"
#include "byre/input_error.h"
#include "byre/recording.h"
#include "byre/trajectory_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

CowshedRecordingOptions small_visit(int mission, int threads) {
  CowshedRecordingOptions options;
  options.barn.mission = mission;
  options.duration_s = 9.0;
  options.frame_rate_hz = 1.0;
  options.image_divisor = 4;
  options.threads = threads;
  return options;
}

std::vector<ImageFrame> first_frames(CowshedRecording& recording, int count) {
  std::vector<ImageFrame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(recording.render_next());
  return frames;
}

std::uint8_t grey_at(const Image& image, double u, double v) {
  return image.pixels[static_cast<std::size_t>(std::lround(v) * image.width + std::lround(u))];
}

// Mean absolute difference of grey values between 5 x 5 pixels of both images.
double difference(const Image& left, const Vector2d& in_left, const Image& right, const Vector2d& in_right) {
  double sum = 0.0;
  for (int dv = -2; dv <= 2; ++dv) {
    for (int du = -2; du <= 2; ++du) {
      sum += std::abs(grey_at(left, in_left.x() + du, in_left.y() + dv) -
                      grey_at(right, in_right.x() + du, in_right.y() + dv));
    }
  }
  return sum / 25.0;
}

// Rendered once; the tests only read it.
class CowshedVisit : public ::testing::Test {
 protected:
  struct Rendered {
    CowshedRecording recording{small_visit(1, 0)};
    std::vector<ImageFrame> frames = first_frames(recording, 2);
  };
  static const Rendered& rendered() {
    static const Rendered visit;
    return visit;
  }

  const CowshedRecording& recording = rendered().recording;
  const std::vector<ImageFrame>& frames = rendered().frames;
};

TEST_F(CowshedVisit, HasTheSameBytesForAnyNumberOfThreads) {
  CowshedRecording again(small_visit(1, 3));
  for (const ImageFrame& frame : frames) {
    const ImageFrame repeated = again.render_next();
    EXPECT_EQ(repeated.time, frame.time);
    EXPECT_EQ(repeated.left.pixels, frame.left.pixels);
    EXPECT_EQ(repeated.right->pixels, frame.right->pixels);
  }
}

TEST_F(CowshedVisit, DiffersBetweenMissions) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecording later(small_visit(2, 0));
  EXPECT_NE(later.render_next().left.pixels, frames.front().left.pixels);
  EXPECT_GT(later.times().front(), recording.times().back());
}

TEST_F(CowshedVisit, IsWellExposedFromTheFirstFrame) {
  for (const ImageFrame& frame : frames) EXPECT_NEAR(mean_grey(frame.left), ExposureLimits{}.target_grey, 12.0);
}

TEST(CowshedVisits, AreNoisierInDimLightAndBlackInDarkness) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const auto first_two = [](const NightOptions& night) {
    CowshedRecordingOptions options = small_visit(1, 1);
    options.night = night;
    CowshedRecording recording(options);
    return first_frames(recording, 2);
  };
  const std::vector<ImageFrame> day = first_two({});
  const std::vector<ImageFrame> evening = first_two({.light = 0.2});
  EXPECT_NEAR(mean_grey(evening[0].left), mean_grey(day[0].left), 20.0f) << "exposed longer, and amplified";
  EXPECT_GT(measure_condition(evening[0].left).noise, 1.2f * measure_condition(day[0].left).noise);
  EXPECT_LT(mean_grey(first_two({.light = 0.02})[0].left), 40.0f) << "no exposure is long enough";

  const std::vector<ImageFrame> out = first_two({.lights_out = 0.5, .lights_on = 2.0});
  EXPECT_EQ(out[0].left.pixels, day[0].left.pixels);
  EXPECT_LT(mean_grey(out[1].left), 2.0f);
  EXPECT_GT(mean_grey(first_two({.headlight = 10.0, .lights_out = 0.5, .lights_on = 2.0})[1].left), 5.0f);
}

TEST_F(CowshedVisit, ShowsLeftPixelsInTheRightImageByDepth) {
  const Calibration& calibration = recording.calibration();
  const std::vector<float> depths = recording.left_depths(frames[1].time);
  const Image& left = frames[1].left;
  int looked_at = 0;
  int best_where_predicted = 0;
  for (int row = 20; row < left.height - 20; row += 4) {
    for (int column = 30; column < left.width - 20; column += 4) {
      const Vector2d pixel(column, row);
      const Vector3d bearing = calibration.left.bearing(pixel).value();
      const double depth = depths[static_cast<std::size_t>(row * left.width + column)];
      // Skips far and untextured pixels.
      if (depth > 4.0 || difference(left, pixel, left, pixel + Vector2d(2.0, 0.0)) < 12.0) continue;
      const Vector3d point_in_left = bearing * (depth / bearing.z());
      const auto predicted = calibration.right->camera.project(calibration.right->right_from_left * point_in_left);
      if (!predicted || predicted->x() < 6.0) continue;
      const auto with_offset = [&](double offset) {
        return difference(left, pixel, *frames[1].right, *predicted + Vector2d(offset, 0.0));
      };
      ++looked_at;
      best_where_predicted += with_offset(0.0) < std::min(with_offset(-2.0), with_offset(2.0)) ? 1 : 0;
    }
  }
  ASSERT_GT(looked_at, 30);
  EXPECT_GT(best_where_predicted, 0.8 * looked_at);
}

TEST_F(CowshedVisit, ShowsItsMarksAtTheirDepth) {
  const std::vector<MarkSighting> sightings = recording.sightings();
  ASSERT_FALSE(sightings.empty());
  for (const MarkSighting& sighting : sightings) {
    const auto mark = std::ranges::find(recording.barn().marks, sighting.name, &NamedPoint::name);
    ASSERT_NE(mark, recording.barn().marks.end());
    const Pose world_from_camera = recording.world_from_body(sighting.time) * recording.calibration().body_from_left;
    const Vector3d in_camera = inverse(world_from_camera) * mark->point_in_world;
    const std::vector<float> depths = recording.left_depths(sighting.time);
    const auto i =
        std::lround(sighting.pixel.y()) * recording.calibration().left.width + std::lround(sighting.pixel.x());
    EXPECT_NEAR(depths[static_cast<std::size_t>(i)], in_camera.z(), 0.05) << sighting.name;
  }
}

TEST_F(CowshedVisit, ProvidesTheTruthAtAndBetweenFrames) {
  const Trajectory truth = recording.truth();
  EXPECT_THAT(truth, SizeIs(8 * 200 + 1));
  for (const Timestamp time : recording.times()) {
    const auto sample = std::ranges::find(truth, time, &StampedPose::time);
    ASSERT_NE(sample, truth.end());
    EXPECT_THAT(sample->world_from_body, PoseNear(recording.world_from_body(time), 0.0, 1e-12));
  }
}

TEST_F(CowshedVisit, ProvidesPicksInTheFrameOfItsFirstPose) {
  const Pose world_from_first_body = recording.world_from_body(recording.times().front());
  const std::vector<MarkPick> picks = picks_of(recording.barn().marks, world_from_first_body);
  ASSERT_EQ(picks.size(), recording.barn().marks.size());
  for (std::size_t i = 0; i < picks.size(); ++i) {
    const Vector3d in_world = world_from_first_body * picks[i].point_in_map;
    EXPECT_LT((in_world - recording.barn().marks[i].point_in_world).norm(), 1e-9);
    EXPECT_LT((in_world.head<2>() - picks[i].point_in_plan).norm(), 1e-9);
  }
}

CowshedRecordingOptions miscalibrated_visit(const CameraImperfection& camera) {
  CowshedRecordingOptions options = small_visit(1, 0);
  options.camera = camera;
  return options;
}

TEST_F(CowshedVisit, IsRenderedByTheTrueCalibration) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecording erring(miscalibrated_visit({.calibration_level = 1.0, .calibration_seed = 3}));
  EXPECT_EQ(erring.render_next().left.pixels, frames[0].left.pixels);
  EXPECT_EQ(erring.calibration().left.fx, recording.calibration().left.fx);
  EXPECT_NE(erring.nominal_calibration().left.fx, erring.calibration().left.fx);
  EXPECT_EQ(recording.nominal_calibration().left.fx, recording.calibration().left.fx);
  EXPECT_TRUE(recording.is_calibration_exact());
  EXPECT_FALSE(erring.is_calibration_exact());
}

TEST_F(CowshedVisit, IsRenderedLaterByTheRightCameraWithATimeOffset) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecording late(miscalibrated_visit({.time_offset_s = 0.1}));
  const std::vector<ImageFrame> seen = first_frames(late, 2);
  EXPECT_EQ(seen[1].left.pixels, frames[1].left.pixels);
  EXPECT_NE(seen[1].right->pixels, frames[1].right->pixels);
}

TEST_F(CowshedVisit, IsBrighterBlurredAndCompressedByTheCameras) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecording bright(miscalibrated_visit({.gain = 1.2, .offset = 5.0}));
  const ImageFrame seen = bright.render_next();
  EXPECT_EQ(seen.left.pixels, frames[0].left.pixels);
  EXPECT_NEAR(mean_grey(*seen.right), 1.2f * mean_grey(*frames[0].right) + 5.0f, 5.0f);
  CowshedRecording lossy(miscalibrated_visit({.jpeg_quality = 60}));
  EXPECT_NE(lossy.render_next().left.pixels, frames[0].left.pixels);
  CowshedRecording soft(miscalibrated_visit({.lens_blur = 2.0}));
  EXPECT_NE(soft.render_next().left.pixels, frames[0].left.pixels);
}

double difference_of_rows(const Image& a, const Image& b, int first, int last) {
  double sum = 0.0;
  for (int i = first * a.width; i < last * a.width; ++i) {
    sum += std::abs(int{a.pixels[static_cast<std::size_t>(i)]} - int{b.pixels[static_cast<std::size_t>(i)]});
  }
  return sum / ((last - first) * a.width);
}

TEST(CowshedVisits, AreRenderedAtTheMiddleRowTimeOfARollingShutter) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecordingOptions options = small_visit(1, 0);
  options.duration_s = 20.0;
  CowshedRecording at_once(options);
  options.camera.rolling_shutter_s = 0.1;
  CowshedRecording rolling(options);
  const Image whole = first_frames(at_once, 5).back().left, rolled = first_frames(rolling, 5).back().left;
  const int middle = whole.height / 2;
  const double in_the_middle = difference_of_rows(whole, rolled, middle - 2, middle + 2);
  EXPECT_LT(in_the_middle, 0.4 * difference_of_rows(whole, rolled, whole.height - 12, whole.height));
  EXPECT_GT(in_the_middle, 0.0);
}

TEST(CowshedVisits, ShowMarksWithRollingShutterOffsets) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecordingOptions options = small_visit(1, 0);
  const std::vector<MarkSighting> at_once = CowshedRecording(options).sightings();
  options.camera.rolling_shutter_s = 0.1;
  const CowshedRecording rolling(options);
  const std::vector<MarkSighting> rolled = rolling.sightings();
  ASSERT_FALSE(rolled.empty());
  int moved = 0;
  for (const MarkSighting& sighting : rolled) {
    const auto mark = std::ranges::find(rolling.barn().marks, sighting.name, &NamedPoint::name);
    const double row_s = 0.1 * ((sighting.pixel.y() + 0.5) / rolling.calibration().left.height - 0.5);
    const Pose world_from_body = rolling.world_from_body(sighting.time + from_seconds(row_s));
    const Vector3d in_camera = inverse(world_from_body * rolling.calibration().body_from_left) * mark->point_in_world;
    EXPECT_LT((rolling.calibration().left.project(in_camera).value() - sighting.pixel).norm(), 0.01) << sighting.name;
    const auto before = std::ranges::find(at_once, sighting.name, &MarkSighting::name);
    moved += before == at_once.end() || (before->pixel - sighting.pixel).norm() > 0.05 ? 1 : 0;
  }
  EXPECT_GT(moved, 0);
}

// Whether the robot's volume is free of obstacles between two poses.
bool is_clear(const RayScene& rays, const Pose& before, const Pose& after) {
  for (const double side : {-0.35, 0.0, 0.35}) {
    for (const double height : {0.15, 0.5, 1.0}) {
      const Vector3d corner(0.4, side, height);
      if (!rays.is_free((before * corner).cast<float>(), (after * corner).cast<float>())) return false;
    }
  }
  return true;
}

TEST(CowshedVisits, DoNotDriveThroughObjects) {
  constexpr double kStep_s = 0.1;
  for (const int mission : {1, 2, 3}) {
    CowshedRecordingOptions options;
    options.barn.mission = mission;
    options.duration_s = 60.0;
    const RayScene rays(build_cowshed(options.barn).still, 0);
    const FeedingCourse course(course_of(options));
    for (double time_s = 0.0; time_s < options.duration_s; time_s += kStep_s) {
      const Pose here = course.world_from_body(time_s);
      EXPECT_TRUE(is_clear(rays, here, course.world_from_body(time_s + kStep_s)))
          << "mission " << mission << " at " << here.translation.transpose();
    }
  }
}

TEST(CowshedVisits, StartWhereRequested) {
  CowshedRecordingOptions options;
  options.barn.mission = 2;
  options.start = 0.75;
  const FeedingCourseOptions course = course_of(options);
  EXPECT_EQ(course.start, 0.75);
  options.start.reset();
  EXPECT_LT(course_of(options).start, 0.1);
  EXPECT_EQ(course_of(options).shift_y, course.shift_y);
  options.start = 1.5;
  EXPECT_THROW(CowshedRecording{options}, InputError);
}

TEST(CowshedVisits, EnterTheFeedStoreThroughTheOpenGate) {
  const auto farthest = [](BarnGate gate) {
    CowshedRecordingOptions options;
    options.barn.mission = 2;
    options.barn.gate = gate;
    options.duration_s = 60.0;
    const FeedingCourse course(course_of(options));
    double x = 0.0;
    for (double time_s = 0.0; time_s < options.duration_s; time_s += 0.1) {
      x = std::max(x, course.world_from_body(time_s).translation.x());
    }
    return x;
  };
  EXPECT_LT(farthest(BarnGate::closed), kCowshedSize.length - 1.0);
  EXPECT_GT(farthest(BarnGate::open), kCowshedSize.length + 5.0);
}

TEST(CowshedPlan, ShowsColumnsAndAFreeAlley) {
  const FloorPlanImage plan = draw_floor_plan(build_cowshed({}).outlines);
  const auto grey = [&](double x, double y) {
    const Vector2d cell = (Vector2d(x, y) - plan.origin) / plan.resolution;
    const int row = plan.image.height - 1 - static_cast<int>(cell.y());
    return plan.image.pixels[static_cast<std::size_t>(row * plan.image.width + static_cast<int>(cell.x()))];
  };
  EXPECT_EQ(grey(7.5, 3.0), 0);
  EXPECT_EQ(grey(7.5, -3.0), 0);
  EXPECT_EQ(grey(7.5, 3.3), 254);
  EXPECT_EQ(grey(15.0, 0.0), 254);
  EXPECT_EQ(grey(15.0, 2.5), 0);  // curb
  EXPECT_EQ(grey(-0.5, 0.0), 254);
  EXPECT_EQ(grey(30.0, 0.0), 254);  // gate
  EXPECT_EQ(grey(30.0, 2.5), 0);
  EXPECT_EQ(grey(40.0, 0.0), 0);  // far wall of the store
}

class WrittenCowshed : public ::testing::Test {
 protected:
  ~WrittenCowshed() override { fs::remove_all(folder); }

  static std::string text_of(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }

  const fs::path folder = fs::path(::testing::TempDir()) / "byre_written_cowshed";
};

TEST_F(WrittenCowshed, IsReadAsARecordingWithTruthAndFloorPlan) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecordingOptions options = small_visit(1, 0);
  options.duration_s = 0.1;
  options.frame_rate_hz = 20.0;
  CowshedRecording recording(options);
  std::vector<int> progress;
  write_cowshed_recording(recording, folder, [&](int done) {
    progress.push_back(done);
    return true;
  });
  EXPECT_THAT(progress, ElementsAre(1, 2));

  const auto read = open_recording(folder, {});
  ASSERT_EQ(read->size(), 2);
  EXPECT_EQ(read->times(), recording.times());
  EXPECT_TRUE(read->calibration().right);
  EXPECT_EQ(read->calibration().left.distortion, recording.calibration().left.distortion);
  const std::optional<ImageFrame> frame = read->read(1);
  ASSERT_TRUE(frame && frame->right);
  CowshedRecording again(options);
  EXPECT_EQ(frame->left.pixels, first_frames(again, 2)[1].left.pixels);
  EXPECT_THAT(read_trajectory(folder), SizeIs(11));

  EXPECT_THAT(text_of(folder / "plan" / "plan.yaml"), HasSubstr("image: plan.png\nresolution: 0.02"));
  EXPECT_TRUE(fs::exists(folder / "plan" / "plan.png"));
  const std::vector<TextLine> picks = read_lines(folder / "plan" / "picks.csv");
  ASSERT_EQ(picks.size(), recording.barn().marks.size());
  EXPECT_THAT(split_fields(picks.front().text), SizeIs(6));
}

TEST_F(WrittenCowshed, HasTheErroneousAndTheTrueCalibration) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  CowshedRecordingOptions options = small_visit(1, 0);
  options.duration_s = 0.1;
  options.image_divisor = 8;
  options.camera.calibration_level = 1.0;
  CowshedRecording recording(options);
  write_cowshed_recording(recording, folder, [](int) { return true; });
  const Calibration nominal = open_recording(folder, {})->calibration();
  EXPECT_NEAR(nominal.left.fx, recording.nominal_calibration().left.fx, 1e-9);
  EXPECT_THAT(nominal.right->right_from_left,
              PoseNear(recording.nominal_calibration().right->right_from_left, 1e-9, 1e-9));
  const Calibration& truth = recording.calibration();
  EXPECT_NEAR(read_calibration(folder / "mav0" / "cam0" / "true_sensor.yaml").left.fx, truth.left.fx, 1e-9);
  const Calibration right = read_calibration(folder / "mav0" / "cam1" / "true_sensor.yaml");
  EXPECT_NEAR(right.left.cx, truth.right->camera.cx, 1e-9);
  EXPECT_THAT(right.body_from_left, PoseNear(truth.body_from_left * inverse(truth.right->right_from_left), 1e-9, 1e-9));
}

TEST_F(WrittenCowshed, StopsOnRequest) {
  CowshedRecordingOptions options = small_visit(1, 0);
  options.image_divisor = 8;
  CowshedRecording recording(options);
  write_cowshed_recording(recording, folder, [](int done) { return done < 2; });
  int images = 0;
  for (const Timestamp time : recording.times()) {
    images += fs::exists(folder / "mav0" / "cam0" / "data" / (std::to_string(time.count()) + ".png")) ? 1 : 0;
  }
  EXPECT_EQ(images, 2);
}

TEST_F(WrittenCowshed, RejectsInvalidOptions) {
  CowshedRecordingOptions options;
  options.duration_s = 0.0;
  EXPECT_THROW(CowshedRecording{options}, InputError);
  options = {};
  options.image_divisor = 0;
  EXPECT_THROW(CowshedRecording{options}, InputError);
  options = {};
  options.image_size = {640, 0};
  EXPECT_THROW(CowshedRecording{options}, InputError);
  options = {};
  options.camera.gain = 0.0;
  EXPECT_THROW(CowshedRecording{options}, InputError);
  options = {};
  options.dirt = -1.0;
  EXPECT_THROW(CowshedRecording{options}, InputError);
}

}  // namespace
}  // namespace byre
