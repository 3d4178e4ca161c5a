#include "byre/playback/report/recording_report.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

RecordingCheck check_of_pairs(double features) {
  RecordingCheck check;
  check.rate_hz = 20.0;
  check.gaps = 2;
  check.features = features;
  check.right = CameraCheck{};
  check.pair = PairCheck{.pairs = 8, .matched = 0.53, .row_error = 0.25, .calibration_error = 0.1};
  return check;
}

TEST(RecordingCheckReport, ContainsTheShareOfMatchedFeatures) {
  EXPECT_EQ(summary_of(check_of_pairs(1000.0)),
            "20.0 Hz, 2 gaps; 1000 features, 53 % matched in both images, row error 0.25 px");
  EXPECT_THAT(check_report(check_of_pairs(1000.0), {}, "").text,
              AllOf(HasSubstr("53 % of the features matched in the right image, row error 0.25 px"),
                    HasSubstr("error about 0.10 px (row differences of the pair)")));
}

// The median number of features is zero although some images have features.
TEST(RecordingCheckReport, OmitsTheShareWithoutFeatures) {
  EXPECT_EQ(summary_of(check_of_pairs(0.0)), "20.0 Hz, 2 gaps; 0 features");
  EXPECT_THAT(check_report(check_of_pairs(0.0), {}, "").text,
              AllOf(HasSubstr("0 per image"), Not(HasSubstr("%")), Not(HasSubstr("row differences"))));
}

TEST(RecordingCheckReport, OmitsTheShareForOneCamera) {
  RecordingCheck check = check_of_pairs(1000.0);
  check.right.reset();
  check.pair.reset();
  EXPECT_EQ(summary_of(check), "20.0 Hz, 2 gaps; 1000 features");
}

}  // namespace
}  // namespace byre
