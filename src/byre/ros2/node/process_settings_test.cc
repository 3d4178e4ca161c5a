#include "byre/ros2/node/process.h"

#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mman.h>

namespace byre {
namespace {

using testing::IsEmpty;

// Log lines of applying the settings, which are then reverted.
std::string log_of(const NodeConfig& config, int& policy) {
  std::string lines;
  apply_process_settings(config, [&lines](LogLevel, const std::string& line) { lines += line + "\n"; });
  policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  const sched_param usual{};
  sched_setscheduler(0, SCHED_OTHER, &usual);
  munlockall();
  return lines;
}

TEST(ProcessSettings, ChangeNothingByDefault) {
  int policy = 0;
  EXPECT_THAT(log_of({}, policy), IsEmpty());
  EXPECT_EQ(policy, SCHED_OTHER);
}

TEST(ProcessSettings, SetThePriorityOrReportWhyNot) {
  NodeConfig config;
  config.priority = 10;
  int policy = 0;
  const std::string lines = log_of(config, policy);
  const bool is_first = policy == SCHED_RR;
  EXPECT_EQ(lines.empty(), is_first);
  EXPECT_EQ(lines.find("raise LimitRTPRIO") == std::string::npos, is_first);
}

}  // namespace
}  // namespace byre
