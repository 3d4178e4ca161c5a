#include "byre/node/metrics.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(MetricsText, ContainsEachFigureWithItsMeaning) {
  NodeFigures figures{20, 3, 17, {}};
  EXPECT_THAT(
      metrics_text(figures),
      HasSubstr(
          "# HELP byre_images_total Received left images\n# TYPE byre_images_total counter\nbyre_images_total 20\n"));
  EXPECT_THAT(metrics_text(figures), Not(HasSubstr("byre_verdict")));
  figures.last.emplace();
  figures.last->health.verdict = Verdict::degraded;
  figures.last->health.position_sigma = 0.0125;
  EXPECT_THAT(metrics_text(figures), HasSubstr("\nbyre_verdict 1\n"));
  EXPECT_THAT(metrics_text(figures), HasSubstr("\nbyre_position_sigma_metres 0.0125\n"));
}

}  // namespace
}  // namespace byre
