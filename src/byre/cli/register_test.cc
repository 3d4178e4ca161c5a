#include "byre/cli/register_fixture.h"
#include "byre/cli/register_report.h"
#include "byre/input/input_error.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class RegisterMap : public testing::Test {
 protected:
  ~RegisterMap() override { std::filesystem::remove(picks_); }

  Registering register_with(const StoredMap& stored, const std::vector<PlanCorrespondence>& correspondences) const {
    std::ofstream(picks_) << picks_csv(correspondences);
    return register_map(stored, "barn.byre", plan_, picks_, {});
  }

  FloorPlan plan_{"plan.yaml", "plan.png", 420, 140, Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero()};
  std::filesystem::path picks_ =
      std::filesystem::path(testing::TempDir()) / ("register_" + std::to_string(getpid()) + ".csv");
};

TEST_F(RegisterMap, KnowsThePlaceOfThePathBetterWithSmallerResiduals) {
  FloorPlanScene scene;
  const StoredMap stored = driven_barn(scene);
  const Registering exact = register_with(stored, scene.correspondences(12));
  const Registering noisy = register_with(stored, scene.correspondences(12, 0.2));
  EXPECT_THAT(exact.correspondences, SizeIs(12));
  EXPECT_LT(exact.largest_path_sigma, 0.02);
  EXPECT_GT(noisy.largest_path_sigma, 3.0 * exact.largest_path_sigma);
}

TEST_F(RegisterMap, FindsAScaleOnlyForAMapWithoutOne) {
  FloorPlanScene scene(1, 2.0);
  StoredMap stored = driven_barn(scene);
  stored.scale = MapScale::unknown;
  const Registering registering = register_with(stored, scene.correspondences(6));
  EXPECT_NEAR(registering.fit.registration.plan_from_map.scale, 2.0, 1e-6);
  EXPECT_THAT(to_text(registering, {"barn.byre", plan_, ""}), HasSubstr("scale        2 m per unit of the map"));
  FloorPlanScene metric;
  const Registering rigid = register_with(driven_barn(metric), metric.correspondences(6));
  EXPECT_THAT(to_text(rigid, {"barn.byre", plan_, ""}), AllOf(Not(HasSubstr("scale")), Not(HasSubstr("written"))));
}

TEST_F(RegisterMap, NeedsAMapThatTellsWhichWayIsUp) {
  EXPECT_THROW(register_with(StoredMap(), FloorPlanScene().correspondences(6)), InputError);
}

}  // namespace
}  // namespace byre::cli
