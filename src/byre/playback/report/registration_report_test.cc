#include "byre/playback/report/map_report.h"

#include "byre/playback/archive/register_scene.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class RegisterReport : public testing::Test {
 protected:
  ~RegisterReport() override { std::filesystem::remove(picks_); }

  Registering register_with(const StoredMap& stored, const std::vector<PlanCorrespondence>& correspondences) const {
    std::ofstream(picks_) << picks_csv(correspondences);
    return register_map(stored, "barn.byre", plan_, picks_, {});
  }

  FloorPlan plan_{"plan.yaml", "plan.png", 420, 140, Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero()};
  std::filesystem::path picks_ =
      std::filesystem::path(testing::TempDir()) / ("register_report_" + std::to_string(getpid()) + ".csv");
};

TEST_F(RegisterReport, ContainsTheEstimatedScaleOfAnUnscaledMap) {
  FloorPlanScene scene(1, 2.0);
  StoredMap stored = driven_barn(scene);
  stored.scale = MapScale::unknown;
  const Registering registering = register_with(stored, scene.correspondences(6));
  EXPECT_THAT(registration_report(registering, {"barn.byre", plan_, "", {}}).text,
              HasSubstr("scale        2 m per unit of the map"));
  FloorPlanScene metric;
  const Registering rigid = register_with(driven_barn(metric), metric.correspondences(6));
  EXPECT_THAT(registration_report(rigid, {"barn.byre", plan_, "", {}}).text,
              AllOf(HasSubstr("scale        agrees with the plan: 0.00 % +- 0.0"), Not(HasSubstr("written"))));
}

TEST_F(RegisterReport, OffersScaleCorrectionForMapsWithABaseline) {
  FloorPlanScene scene(1, 1.0 / 1.016);
  StoredMap stored = driven_barn(scene);
  const auto correspondences = scene.correspondences(8, 0.03);
  const Registering registering = register_with(stored, correspondences);
  EXPECT_THAT(
      registration_report(registering, {"barn.byre", plan_, "", {}}).text,
      ContainsRegex("scale        the map is 1\\.[56]. % \\+- 0\\.[01]. % too large: correct it with --fix-scale\n"));
  stored.pose_source = PoseSource::given;
  EXPECT_THAT(registration_report(register_with(stored, correspondences), {"barn.byre", plan_, "", {}}).text,
              AllOf(HasSubstr("too large for the plan\n"), Not(HasSubstr("--fix-scale"))));
}

}  // namespace
}  // namespace byre
