#include "byre/geometry/baseline.h"

#include "byre/input_error.h"

#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;

Calibration pair_with_baseline(double metres) {
  Calibration calibration;
  calibration.right.emplace();
  calibration.right->right_from_left.translation = -metres * Eigen::Vector3d(0.6, 0.0, 0.8);
  return calibration;
}

std::string refusal(const Calibration& calibration, const std::optional<double>& confirmed = {}) {
  try {
    with_checked_baseline(calibration, confirmed, "camchain.yaml", "--baseline ");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Baseline, IsAcceptedForRobotsAndCars) {
  for (const double metres : {0.005, 0.06, 0.11, 0.54, 1.0}) {
    const Calibration given = pair_with_baseline(metres);
    EXPECT_EQ(with_checked_baseline(given, {}, "", ""), given) << metres;
  }
}

TEST(Baseline, IsNotCheckedForOneCamera) {
  EXPECT_EQ(with_checked_baseline({}, {}, "", ""), Calibration{});
  EXPECT_THAT(refusal({}, 0.1), HasSubstr("one camera"));
}

TEST(Baseline, InCentimetresOrMillimetresIsRejectedWithACorrection) {
  EXPECT_THAT(refusal(pair_with_baseline(7.5)),
              ::testing::AllOf(HasSubstr("camchain.yaml"), HasSubstr("7.5 m"), HasSubstr("--baseline 0.075"),
                               HasSubstr("--baseline 7.5")));
  EXPECT_THAT(refusal(pair_with_baseline(120.0)), HasSubstr("--baseline 0.12"));
}

TEST(Baseline, OfTensOfMetresOrMicrometresCannotBeConfirmed) {
  EXPECT_THAT(refusal(pair_with_baseline(15.0)), ::testing::Not(HasSubstr("--baseline 15")));
  EXPECT_THAT(refusal(pair_with_baseline(7.5e-5)), ::testing::Not(HasSubstr("confirm")));
}

TEST(Baseline, ReplacesTheLengthAndKeepsTheDirectionIfConfirmed) {
  const Calibration corrected = with_checked_baseline(pair_with_baseline(7.5), 0.075, "", "");
  EXPECT_LT(
      (corrected.right->right_from_left.translation - pair_with_baseline(0.075).right->right_from_left.translation)
          .norm(),
      1e-12);
  EXPECT_NEAR(baseline_of(with_checked_baseline(pair_with_baseline(7.5), 7.5, "", "")), 7.5, 1e-12);
}

TEST(Baseline, IsRejectedIfNotPositive) {
  EXPECT_THAT(refusal(pair_with_baseline(0.1), 0.0), HasSubstr("positive"));
  EXPECT_THAT(refusal(pair_with_baseline(0.0), 0.1), HasSubstr("direction"));
}

}  // namespace
}  // namespace byre
