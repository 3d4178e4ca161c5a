#include "byre/site.h"
#include "byre/slam/system/slam_scene.h"

#include <algorithm>
#include <filesystem>
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

  SiteMap map_named(const std::string& name) const {
    if (const fs::path copy = folder_ / (name + ".byre"); !fs::exists(copy)) fs::copy_file(folder_ / "room.byre", copy);
    return {name, folder_ / (name + ".byre")};
  }
  static std::vector<FrameReport> reports_of(Slam slam) {
    std::vector<FrameReport> reports;
    for (const ImageFrame& frame : shared_frames()) reports.push_back(slam.process(view_of(frame)));
    return reports;
  }
  static std::vector<FrameReport> mission_on(const Site& site) {
    return reports_of(Slam::on_site(open_shared()->calibration(), site, repeatable()));
  }
  static auto trusted(const std::vector<FrameReport>& reports) {
    return std::ranges::count(reports, Verdict::trusted,
                              [](const FrameReport& report) { return report.health.verdict; });
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("byre_site_test." + std::to_string(getpid()));
};

TEST_F(SiteTest, OfOneMapEqualsItsMap) {
  const auto alone = reports_of(Slam::on_map(open_shared()->calibration(), folder_ / "room.byre", repeatable()));
  const auto in_site = mission_on({"farm", {map_named("room")}, {}});
  ASSERT_GT(trusted(alone), 0);
  EXPECT_EQ(trusted(in_site), trusted(alone));
  EXPECT_EQ(in_site.back().map, "room");
  EXPECT_EQ(alone.back().map, "");
  EXPECT_EQ(in_site.back().map_from_body->translation, alone.back().map_from_body->translation);
}

TEST_F(SiteTest, TrustsNoPoseInTwoRoomsThatLookAlike) {
  EXPECT_EQ(trusted(mission_on({"farm", {map_named("room"), map_named("twin")}, {}})), 0);
}

TEST_F(SiteTest, RefusesALinkOnThePlanOfAMapWithoutOne) {
  SiteLink link;
  link.to = 1;
  link.polygon = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}};
  EXPECT_THAT(error_by([&] {
                mission_on({"farm", {map_named("room"), map_named("twin")}, {link}});
              }),
              HasSubstr("room.byre: is not registered on a floor plan"));
}

TEST_F(SiteTest, NeedsAMapAndIsNoMapItself) {
  EXPECT_THAT(error_by([&] { mission_on({"farm", {}, {}}); }), HasSubstr("has no map"));
  EXPECT_THAT(error_by([&] { Slam::on_map(open_shared()->calibration(), folder_ / "site.yaml", repeatable()); }),
              HasSubstr("is a site, not a map"));
}

}  // namespace
}  // namespace byre
