#include "byre/base/job_slot.h"

#include "byre/base/job_slot_scene.h"

#include <string>

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(JobSlot, IsIdleUntilAJobIsRequested) {
  JobSlot<int> slot;
  EXPECT_TRUE(slot.is_idle());
  EXPECT_FALSE(slot.take_request());
  EXPECT_FALSE(slot.collect());
}

TEST(JobSlot, IsBusyFromTheRequestUntilItsResultIsCollected) {
  JobSlot<std::string> slot;
  slot.request([] { return std::string("map"); });
  EXPECT_FALSE(slot.is_idle());
  EXPECT_FALSE(slot.collect()) << "not run yet";
  const std::optional<Job> job = slot.take_request();
  ASSERT_TRUE(job);
  EXPECT_FALSE(slot.take_request()) << "taken once";
  EXPECT_FALSE(slot.is_idle()) << "in flight";
  slot.deliver({(*job)(), 0.25});
  EXPECT_FALSE(slot.is_idle()) << "its result waits";
  const auto finished = slot.collect();
  ASSERT_TRUE(finished);
  EXPECT_EQ(finished->result, "map");
  EXPECT_EQ(finished->seconds, 0.25);
  EXPECT_TRUE(slot.is_idle());
  EXPECT_FALSE(slot.collect());
}

// A result may itself be empty, such as that of an unsuccessful search.
TEST(JobSlot, DistinguishesAnEmptyResultFromNone) {
  JobSlot<std::optional<int>> slot;
  slot.request([] { return std::optional<int>(); });
  run_at_once(slot);
  const auto finished = slot.collect();
  ASSERT_TRUE(finished);
  EXPECT_FALSE(finished->result);
}

TEST(JobSlot, HasIndependentCopies) {
  JobSlot<int> slot;
  slot.request([] { return 7; });
  JobSlot<int> copy = slot;
  run_at_once(slot);
  EXPECT_EQ(slot.collect()->result, 7);
  EXPECT_FALSE(copy.is_idle());
  run_at_once(copy);
  EXPECT_EQ(copy.collect()->result, 7);
}

}  // namespace
}  // namespace byre
