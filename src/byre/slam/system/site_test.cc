#include "byre/slam/system/slam_scene.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A folder with a map of the shared recording.
class SiteTest : public testing::Test {
 protected:
  SiteTest() {
    fs::create_directories(folder_);
    Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
    causal(slam, shared_frames());
    slam.finish();
    slam.save(folder_ / "room.byre");
  }
  ~SiteTest() override { fs::remove_all(folder_); }

  fs::path write_site(const std::string& maps, const std::string& links = "") const {
    fs::path file = folder_ / "site.yaml";
    std::ofstream(file) << "name: farm\nmaps:\n" << maps << links;
    return file;
  }
  static std::vector<FrameReport> mission_on(const fs::path& map) {
    Slam slam = Slam::on_map(open_shared()->calibration(), map, repeatable());
    std::vector<FrameReport> reports;
    for (const ImageFrame& frame : shared_frames()) reports.push_back(slam.process(view_of(frame)));
    return reports;
  }
  static auto trusted(const std::vector<FrameReport>& reports) {
    return std::ranges::count(reports, Verdict::trusted,
                              [](const FrameReport& report) { return report.health.verdict; });
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("byre_site_test." + std::to_string(getpid()));
};

TEST_F(SiteTest, OfOneMapEqualsItsMap) {
  const auto alone = mission_on(folder_ / "room.byre");
  const auto in_site = mission_on(write_site("  - {name: room, map: room.byre}\n"));
  ASSERT_GT(trusted(alone), 0);
  EXPECT_EQ(trusted(in_site), trusted(alone));
  EXPECT_EQ(in_site.back().map, "room");
  EXPECT_EQ(alone.back().map, "");
  EXPECT_EQ(in_site.back().map_from_body->translation, alone.back().map_from_body->translation);
}

TEST_F(SiteTest, TrustsNoPoseInTwoRoomsThatLookAlike) {
  fs::copy_file(folder_ / "room.byre", folder_ / "twin.byre");
  EXPECT_EQ(trusted(mission_on(write_site("  - {name: room, map: room.byre}\n  - {name: twin, map: twin.byre}\n"))), 0);
}

TEST_F(SiteTest, RefusesALinkOnThePlanOfAMapWithoutOne) {
  fs::copy_file(folder_ / "room.byre", folder_ / "twin.byre");
  const fs::path site = write_site("  - {name: room, map: room.byre}\n  - {name: twin, map: twin.byre}\n",
                                   "links:\n  - {kind: gate, from: room, to: twin, centre: [0, 0], radius: 1}\n");
  EXPECT_THAT(error_by([&] { Slam::on_map(open_shared()->calibration(), site, repeatable()); }),
              HasSubstr("room.byre: is not registered on a floor plan"));
}

}  // namespace
}  // namespace byre
