// Missions on a site: two parts of a simulated barn, and another barn of the same builder.

#include "byre/recording.h"
#include "byre/simulation/cowshed/cowshed_recording.h"
#include "byre/site.h"
#include "byre/slam.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

constexpr double kWorstError = 0.05;  // metres, of trusted poses
constexpr int kDriveFrames = 176;
// Frames of the barn that the maps of its two parts were made from.
constexpr std::array<int, 2> kFirstPart{0, 100};
constexpr std::array<int, 2> kSecondPart{85, kDriveFrames};

// The robot drives 6 m ahead, turns and drives back. Each map begins at the body of its first frame.
class SiteMissions : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::path(testing::TempDir()) / ("byre_site_missions." + std::to_string(getpid()));
    render("barn", 1);
    render("other", 2);
    make_map("first", "barn", kFirstPart);
    make_map("second", "barn", kSecondPart);
    make_map("other", "other", {0, kDriveFrames});
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static void render(const std::string& recording, std::uint64_t seed) {
    CowshedRecordingOptions options;
    options.barn.seed = seed;
    options.image_divisor = 2;
    options.frame_rate_hz = 8.0;
    options.duration_s = kDriveFrames / options.frame_rate_hz;
    CowshedRecording barn(options);
    write_cowshed_recording(barn, folder_ / recording, [](int) { return true; });
    for (const Timestamp time : barn.times()) truth_[recording].push_back(barn.world_from_body(time));
  }
  static void make_map(const std::string& name, const std::string& recording, const std::array<int, 2>& frames) {
    const auto opened = open(recording);
    Slam slam = Slam::mapping(opened->calibration(), repeatable());
    for (int i = frames[0]; i < frames[1]; ++i) slam.process(view_of(*opened->read(i)));
    slam.finish();
    slam.save(folder_ / (name + ".byre"));
    maps_.push_back({name, folder_ / (name + ".byre")});
    map_from_world_[name] = inverse(truth_[recording][static_cast<std::size_t>(frames[0])]);
  }
  static SlamOptions repeatable() {
    SlamOptions options;
    options.workers = Workers::repeatable;
    return options;
  }
  static std::unique_ptr<Recording> open(const std::string& recording) {
    return open_recording(folder_ / recording, {});
  }
  // A gate in the middle of the frames that both parts were made from.
  static SiteLink gate() {
    const Pose& world_from_body = truth_["barn"][static_cast<std::size_t>((kFirstPart[1] + kSecondPart[0]) / 2)];
    return {.from = 0, .to = 1, .centre = (map_from_world_["first"] * world_from_body).translation, .radius = 1.0};
  }

  struct Tour {
    std::vector<std::string> maps;  // maps of trusted poses, in order
    int trusted = 0;
    int changes = 0;
    double worst_trusted_error = 0.0;  // metres
  };

  void drive(Slam& slam, const std::string& recording, int first, int end) {
    const auto opened = open(recording);
    for (int i = first; i < end; ++i) {
      ImageFrame frame = opened->read(i).value();
      frame.time += later_;
      const FrameReport report = slam.process(view_of(frame));
      tour_.changes += report.has(SessionEvent::map_changed);
      if (report.health.verdict != Verdict::trusted) continue;
      ++tour_.trusted;
      if (tour_.maps.empty() || tour_.maps.back() != report.map) tour_.maps.push_back(report.map);
      const Pose truth = map_from_world_[report.map] * truth_[recording][static_cast<std::size_t>(i)];
      tour_.worst_trusted_error =
          std::max(tour_.worst_trusted_error, (report.map_from_body->translation - truth.translation).norm());
    }
  }

  static inline fs::path folder_;
  static inline std::map<std::string, std::vector<Pose>> truth_;  // world_from_body by recording
  static inline std::map<std::string, Pose> map_from_world_;
  static inline std::vector<SiteMap> maps_;
  Tour tour_;
  Timestamp later_{};  // added to the recordings' times
};

TEST_F(SiteMissions, ChangeTheMapAtAGate) {
  Slam slam = Slam::on_site(open("barn")->calibration(), {"farm", maps_, {gate()}}, repeatable());
  drive(slam, "barn", 0, kDriveFrames);
  EXPECT_THAT(tour_.maps, ElementsAre("first", "second"));
  EXPECT_EQ(tour_.changes, 1);
  EXPECT_GT(tour_.trusted, 0.7 * kDriveFrames);
  EXPECT_LT(tour_.worst_trusted_error, kWorstError);
}

TEST_F(SiteMissions, FindTheMapOnWakingUpElsewhere) {
  Slam slam = Slam::on_site(open("barn")->calibration(), {"farm", maps_, {}}, repeatable());
  drive(slam, "barn", 0, 30);
  later_ += std::chrono::seconds(60);
  drive(slam, "other", 60, 115);
  later_ += std::chrono::seconds(60);
  drive(slam, "barn", 122, kDriveFrames);
  EXPECT_THAT(tour_.maps, ElementsAre("first", "other", "second"));
  EXPECT_EQ(tour_.changes, 2);
  EXPECT_LT(tour_.worst_trusted_error, kWorstError);
}

}  // namespace
}  // namespace byre
