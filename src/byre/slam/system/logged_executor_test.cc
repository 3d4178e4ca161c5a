#include "byre/slam/system/logged_executor.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

TEST(LoggedExecutor, ReturnsTheResultAndLogsItsTime) {
  JobLog log;
  const auto executor = make_logged_executor(make_inline_executor(), log);
  EXPECT_TRUE(executor->idle());
  executor->submit([] { return std::any(); });
  EXPECT_FALSE(executor->idle());
  EXPECT_THAT(log.job_seconds, SizeIs(0));
  const std::optional<FinishedJob> finished = executor->collect();
  ASSERT_TRUE(finished);
  EXPECT_THAT(log.job_seconds, ElementsAre(finished->seconds));
  EXPECT_FALSE(executor->collect());
  EXPECT_THAT(log.job_seconds, SizeIs(1));
}

TEST(LoggedExecutor, CountsAnInlineJobAsTimeOfTheCaller) {
  JobLog log;
  const auto executor = make_logged_executor(make_inline_executor(), log);
  executor->submit([] { return std::any(); });
  executor->collect();
  EXPECT_GE(log.submit_seconds, log.job_seconds.front());
}

TEST(LoggedExecutor, LogsJobsThatEndWithTheRun) {
  JobLog log;
  const auto executor = make_logged_executor(make_paced_executor(4), log);
  executor->submit([] { return std::any(); });
  EXPECT_FALSE(executor->collect());
  EXPECT_TRUE(executor->finish());
  EXPECT_THAT(log.job_seconds, SizeIs(1));
}

}  // namespace
}  // namespace byre
