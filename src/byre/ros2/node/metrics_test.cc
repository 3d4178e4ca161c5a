#include "byre/ros2/node/health_messages.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(MetricsText, ContainsEachFigureWithItsMeaning) {
  NodeCounters counters{20, 3, 17, {}};
  EXPECT_THAT(
      metrics_text(counters),
      HasSubstr(
          "# HELP byre_images_total Received left images\n# TYPE byre_images_total counter\nbyre_images_total 20\n"));
  EXPECT_THAT(metrics_text(counters), Not(HasSubstr("byre_verdict")));
  counters.last.emplace();
  counters.last->health.verdict = Verdict::degraded;
  counters.last->health.position_sigma = 0.0125;
  EXPECT_THAT(metrics_text(counters), HasSubstr("\nbyre_verdict 1\n"));
  EXPECT_THAT(metrics_text(counters), HasSubstr("\nbyre_position_sigma_metres 0.0125\n"));
}

}  // namespace
}  // namespace byre
