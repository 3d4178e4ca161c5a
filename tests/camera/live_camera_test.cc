// Commands on live cameras, simulated by a V4L2 stand-in that plays rendered images, and real ones if available.

#include "byre/calibration_file.h"
#include "byre/cli/shared/program_fixture.h"
#include "byre/recording.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/trajectory_file.h"
#include "mapped_recording.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

const std::string kLeft = "/dev/video-stand-in-left";
const std::string kRight = "/dev/video-stand-in-right";
const std::string kBoth = "/dev/video-stand-in-both";

const fs::path& room() {
  static const RenderedFixture rendered("byre_live_room", 40, 20.0);
  return rendered.folder();
}

class LiveCamera : public ProgramTest {
 protected:
  using Settings = std::map<std::string, std::string>;

  ~LiveCamera() override {
    unsetenv("LD_PRELOAD");
    for (const auto& [name, value] : settings_) unsetenv(("BYRE_STAND_IN_" + name).c_str());
  }

  // Settings of the simulated cameras from now on; writes their calibration to calibration.yaml.
  void plug_in(const fs::path& recording, Settings settings) {
    settings["RECORDING"] = recording.string();
    for (const auto& [name, value] : settings) setenv(("BYRE_STAND_IN_" + name).c_str(), value.c_str(), 1);
    settings_ = settings;
    write("calibration.yaml", write_calibration(open_recording(recording, {})->calibration()));
    setenv("LD_PRELOAD", BYRE_STAND_IN, 1);
  }

  // Compares frames of the written recording with those played. V4L2 timestamps have a resolution of one microsecond.
  void expect_same(const fs::path& written, const fs::path& played, int first, int count) const {
    unsetenv("LD_PRELOAD");
    const auto recorded = open_recording(folder_ / written, {});
    const auto given = open_recording(played, {});
    ASSERT_THAT(recorded->times(), SizeIs(count)) << written;
    for (int i = 0; i < count; ++i) {
      const auto frame = recorded->read(i), other = given->read(first + i);
      ASSERT_TRUE(frame && frame->right && other) << written << " " << i;
      EXPECT_EQ(frame->time / std::chrono::microseconds(1), other->time / std::chrono::microseconds(1));
      EXPECT_EQ(frame->left.pixels, other->left.pixels) << i;
      EXPECT_EQ(frame->right->pixels, other->right->pixels) << i;
    }
    setenv("LD_PRELOAD", BYRE_STAND_IN, 1);
  }

  Settings settings_;
};

std::string count_occurrences(const std::string& text, const std::string& what) {
  int count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return std::to_string(count);
}

TEST_F(LiveCamera, IsListedWithItsFormats) {
  plug_in(room(), {});
  const Outcome outcome = run("camera list " + kLeft);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr(kLeft + ": Stand-in"), HasSubstr("188 x 120 at 20 Hz"),
                                    HasSubstr("of the start of exposure"), HasSubstr("H.264; byre does not read it")));
}

TEST_F(LiveCamera, RejectsAMissingCamera) {
  plug_in(room(), {});
  for (const std::string device : {"/dev/video-stand-in-none", "/dev/null", "/dev"}) {
    const Outcome outcome = run("camera show " + device);
    EXPECT_EQ(outcome.exit_code, 3) << device;
    EXPECT_THAT(outcome.errors, HasSubstr("byre: error: " + device + ": ")) << device;
  }
  EXPECT_THAT(run("camera show " + kLeft + " --size 640x480").errors,
              HasSubstr("delivers no images of 640 x 480 pixels"));
  EXPECT_THAT(run("camera show " + kLeft + " --rate 90").errors,
              HasSubstr("at 90 Hz, available: 188 x 120 GREY at 20 Hz"));
  EXPECT_THAT(run("camera show " + kLeft + " " + kLeft).errors, HasSubstr("stop the other program"));
}

TEST_F(LiveCamera, IsShown) {
  plug_in(room(), {{"SPEED", "2"}});
  const Outcome outcome = run("camera show " + kLeft + " " + kRight + " --duration 0.8 -o still.png");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("start of exposure"), HasSubstr("rate "), HasSubstr("sharpness"),
                                    HasSubstr("corners "), HasSubstr("still.png")));
  EXPECT_EQ(run("camera show " + kLeft + " -o still.jpg").exit_code, 2);
}

TEST_F(LiveCamera, IsRecordedPixelByPixel) {
  plug_in(room(), {{"SPEED", "0"}});
  for (const std::string& devices : {kLeft + " " + kRight, kBoth + " --side-by-side"}) {
    for (const std::string output : {"walk", "walk.mcap"}) {
      fs::remove_all(folder_ / output);
      const Outcome outcome =
          run("camera record " + devices + " -o " + output + " --frames 40 --calibration calibration.yaml");
      ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
      EXPECT_THAT(outcome.output, AllOf(HasSubstr("40, 40 of them pairs"), Not(HasSubstr(" lost"))));
      expect_same(output, room(), 0, 40);
    }
  }
  EXPECT_EQ(run("camera record " + kLeft + " -o walk --frames 1").exit_code, 3) << "the folder contains a recording";
}

TEST_F(LiveCamera, IsRecordedInFormatsOfOtherCameras) {
  for (const char* const format : {"YUYV", "MJPG"}) {
    plug_in(room(), {{"SPEED", "0"}, {"FORMAT", format}});
    const std::string output = std::string("walk_") + format;
    const Outcome outcome =
        run("camera record " + kLeft + " " + kRight + " -o " + output + " --frames 5 --calibration calibration.yaml");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, HasSubstr(std::string("188 x 120 ") + format));
    if (format == std::string("YUYV")) expect_same(output, room(), 0, 5);
  }
}

TEST_F(LiveCamera, IsRecordedFromRealCameraStreams) {
  const fs::path name = "euroc/MH_01_easy";
  const auto recording = find_recording(name);
  if (!recording) GTEST_SKIP() << missing(name);
  plug_in(*recording, {{"SPEED", "0"}, {"FRAMES", "100:60"}});
  const Outcome outcome =
      run("camera record " + kLeft + " " + kRight + " -o walk --frames 60 --calibration calibration.yaml");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  expect_same("walk", *recording, 100, 60);
}

TEST_F(LiveCamera, ReportsLostAndDamagedFrames) {
  plug_in(room(), {{"SPEED", "0"}, {"LOSE", "left:5,left:6,right:20"}, {"DAMAGE", "left:30"}});
  const Outcome outcome =
      run("camera record " + kLeft + " " + kRight + " -o walk --frames 37 --calibration calibration.yaml");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("37, 36 of them pairs"));
  EXPECT_THAT(outcome.output, HasSubstr("37 images, 2 lost, 1 damaged"));
  EXPECT_THAT(outcome.output, HasSubstr("39 images, 1 lost"));
  EXPECT_THAT(outcome.output, HasSubstr("36; 1 left and 3 right images unpaired"));
}

TEST_F(LiveCamera, PairsStampsWithinTheLimitOnly) {
  plug_in(room(), {{"SPEED", "0"}, {"SKEW", "right:4000"}});
  EXPECT_THAT(run("camera record " + kLeft + " " + kRight + " -o near --frames 30").output,
              HasSubstr("30, 30 of them pairs"));
  const Outcome far = run("camera record " + kLeft + " " + kRight + " -o far --frames 30 --pair-limit 3");
  EXPECT_THAT(far.output, HasSubstr("30, 0 of them pairs"));
  EXPECT_THAT(far.errors, HasSubstr("left and right images are 4.0 ms apart"));
}

TEST_F(LiveCamera, ContinuesAfterUnplugging) {
  plug_in(room(), {{"SPEED", "1"}, {"UNPLUG", "right:8:400"}});
  const Outcome outcome =
      run("camera record " + kLeft + " " + kRight + " -o walk --duration 1.9 --calibration calibration.yaml");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(count_occurrences(outcome.errors, kRight + ": was disconnected"), "1") << outcome.errors;
  EXPECT_EQ(count_occurrences(outcome.errors, kRight + ": is back after"), "1") << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("disconnected 1 times"));
  unsetenv("LD_PRELOAD");
  const auto recorded = open_recording(folder_ / "walk", {});
  std::string pairs;
  for (int i = 0; i < recorded->size(); ++i) pairs += recorded->read(i)->right ? 'p' : '.';
  EXPECT_THAT(pairs, testing::MatchesRegex("[.p]*p[.]{3,}[.p]*p[.p]*")) << "left images continue alone";
}

TEST_F(LiveCamera, HasItsStampsInUtc) {
  plug_in(room(), {{"SPEED", "0"}, {"STAMPS", "monotonic"}});
  const auto before = std::chrono::system_clock::now().time_since_epoch();
  const Outcome outcome = run("camera record " + kLeft + " -o walk --frames 10");
  EXPECT_THAT(outcome.output, HasSubstr("kernel clock, converted to UTC"));
  unsetenv("LD_PRELOAD");
  OpenOptions options;
  options.calibration = folder_ / "calibration.yaml";
  options.camera = CameraChoice::left;
  const auto recorded = open_recording(folder_ / "walk", {}, options);
  ASSERT_THAT(recorded->times(), SizeIs(10));
  EXPECT_GT(recorded->times().front(), before - std::chrono::seconds(5));
  EXPECT_LT(recorded->times().front(), before + std::chrono::seconds(60));
}

TEST_F(LiveCamera, IsExposedWithinTheLimit) {
  plug_in(room(), {{"SPEED", "0"}});
  const Outcome outcome = run("camera show " + kLeft + " --duration 1.5 --exposure-limit 6");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const std::size_t at = outcome.output.find("exposure ");
  ASSERT_NE(at, std::string::npos) << outcome.output;
  const double ms = std::strtod(outcome.output.c_str() + at + std::string("exposure ").size(), nullptr);
  EXPECT_GT(ms, 0.0) << outcome.output;
  EXPECT_LE(ms, 6.0) << outcome.output;
}

// Compares positions of a live run on a map with those of a run on the recording that the cameras play.
void expect_same_path(const Trajectory& live, const Trajectory& played, double tolerance) {
  ASSERT_GE(live.size(), 5u) << "on any machine";
  double worst = 0.0;
  int compared = 0;
  for (const StampedPose& sample : live) {
    const auto other = pose_at(played, sample.time, std::chrono::milliseconds(200));
    if (!other) continue;
    worst = std::max(worst, (sample.world_from_body.translation - other->translation).norm());
    ++compared;
  }
  EXPECT_GE(compared, static_cast<int>(live.size()) * 9 / 10);
  EXPECT_LT(worst, tolerance);
}

TEST_F(LiveCamera, IsTrackedLikeItsRecording) {
  const fs::path name = "euroc/MH_01_easy";
  const auto real = find_recording(name);
  const fs::path played = real ? *real : room();
  SCOPED_TRACE(real ? "real images" : "made-up images: " + missing(name));
  const std::string range = real ? "0:60" : "0:40";
  ASSERT_EQ(
      run("map " + played.string() + " --frames " + range + " -o map.byre --trajectory map.txt --quiet").exit_code, 0);
  plug_in(played, {{"SPEED", "0.5"}, {"FRAMES", real ? "0:60" : "0:40"}, {"UNPLUG", "right:12:600"}});
  const Outcome outcome = run("run --live " + kLeft + " " + kRight + " --calibration calibration.yaml --map map.byre " +
                              "--duration " + (real ? "6" : "4") + " --trajectory live.txt --stats stats.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("was disconnected"));
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("skipped"), HasSubstr("disconnected 1 times")));
  EXPECT_THAT(read("stats.json"), HasSubstr("\"format\": \"live\""));
  expect_same_path(read_trajectory(folder_ / "live.txt"), read_trajectory(folder_ / "map.txt"), real ? 0.02 : 0.05);
}

TEST_F(LiveCamera, IsMappedUntilCtrlC) {
  plug_in(room(), {{"SPEED", "1"}});
  const pid_t process =
      start({"map", "--live", kBoth, "--side-by-side", "--calibration", (folder_ / "calibration.yaml").string(), "-o",
             (folder_ / "room.byre").string(), "--trajectory", (folder_ / "room.txt").string()});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("1 frames", "stderr.txt")) << read("stderr.txt");
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_GE(read_trajectory(folder_ / "room.txt").size(), 1u);
  EXPECT_TRUE(fs::exists(folder_ / "room.byre"));
  EXPECT_THAT(read("stdout.txt"), HasSubstr("finishing    skipped"));
}

TEST_F(LiveCamera, RequiresItsOwnCalibration) {
  plug_in(room(), {});
  EXPECT_EQ(run("run --live " + kLeft).exit_code, 2);
  EXPECT_EQ(run("run").exit_code, 2);
  EXPECT_EQ(run("run " + room().string() + " --live " + kLeft + " --calibration calibration.yaml").exit_code, 2);
  EXPECT_EQ(run("run --live " + kLeft + " --calibration calibration.yaml --fps 3").exit_code, 2);
  const Outcome alone = run("run --live " + kLeft + " --calibration calibration.yaml");
  EXPECT_EQ(alone.exit_code, 3);
  EXPECT_THAT(alone.errors, HasSubstr("is of a pair, but one camera is given"));
}

}  // namespace
}  // namespace byre::cli
