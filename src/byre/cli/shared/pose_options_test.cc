#include "byre/cli/shared/pose_options.h"

#include "byre/input_error.h"

#include <gtest/gtest.h>

namespace byre::cli {
namespace {

TEST(PoseFrame, OfAPlanIsRejectedForAnUnregisteredMap) {
  EXPECT_THROW(require_plan(std::nullopt, "barn.byre"), InputError);
  PlanRegistration registration;
  registration.plan_from_map.scale = 2.0;
  EXPECT_EQ(require_plan(registration, "barn.byre").plan_from_map.scale, 2.0);
}

}  // namespace
}  // namespace byre::cli
