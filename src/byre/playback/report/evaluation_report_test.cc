#include "byre/playback/report/evaluation_report.h"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// Five seconds at 20 Hz on a circle of radius 2 m: a path of about 10 m.
Trajectory circle() {
  Trajectory trajectory;
  for (int i = 0; i <= 100; ++i) {
    const double angle = 0.05 * i;
    trajectory.push_back({i * std::chrono::milliseconds(50),
                          {rotation_exp({0.0, 0.0, angle}), {2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0}}});
  }
  return trajectory;
}

Trajectory scaled(Trajectory trajectory, double scale) {
  for (StampedPose& sample : trajectory) sample.world_from_body.translation *= scale;
  return trajectory;
}

EvaluationReport report_of(const Trajectory& estimate, PoseAlignment alignment,
                           const std::optional<ExpectedFrames>& expected = std::nullopt) {
  EvaluationProtocol protocol;
  protocol.label = "final";
  protocol.alignment = alignment;
  return evaluate(estimate, circle(), protocol, expected).value();
}

TEST(EvaluationReport, StatesItsProtocolFirst) {
  EvaluationProtocol protocol;
  protocol.label = "causal";
  protocol.association.time_offset = std::chrono::microseconds(-7500);
  const std::string text =
      evaluation_report(evaluate(circle(), circle(), protocol, {}).value(), "out.txt", "truth.csv").text;
  EXPECT_THAT(text, StartsWith("estimate     out.txt, 101 poses\n"
                               "truth        truth.csv, 101 poses\n"
                               "poses        causal\n"
                               "alignment    SE(3) over all pairs (Umeyama)\n"
                               "association  truth interpolated in gaps up to 60 ms, else its nearest sample within "
                               "2 ms: 100 pairs\n"
                               "time offset  -0.0075 s, added to the truth's time\n"
                               "coverage     "));
}

TEST(EvaluationReport, ReportsAMissingLabel) {
  const std::string text =
      evaluation_report(evaluate(circle(), circle(), EvaluationProtocol{}, {}).value(), "a", "b").text;
  EXPECT_THAT(text, HasSubstr("poses        not stated\n"));
}

TEST(EvaluationReport, HasARowForEachError) {
  const std::string text = evaluation_report(report_of(scaled(circle(), 1.1), PoseAlignment::none), "a", "b").text;
  EXPECT_THAT(text, HasSubstr("ATE            m         0.20000   0.20000   0.20000   0.20000   0.20000      101\n"));
  EXPECT_THAT(text, HasSubstr("ATE            degrees   0.00000"));
  for (const char* const row : {"RPE 1 frame    m", "RPE 1 s        degrees", "RPE 1 m        m"}) {
    EXPECT_THAT(text, HasSubstr(row));
  }
}

TEST(EvaluationReport, ScalesRelativeErrorsByTheSimilarity) {
  const EvaluationReport report = report_of(scaled(circle(), 0.5), PoseAlignment::sim3);
  EXPECT_LT(report.ate->translation.max, 1e-9);
  EXPECT_LT(report.rpe_second.translation.max, 1e-9);
  EXPECT_THAT(evaluation_report(report, "a", "b").text, HasSubstr("Sim(3) over all pairs (Umeyama), scale 2.000000"));
  EXPECT_GT(report_of(scaled(circle(), 0.5), PoseAlignment::se3).rpe_second.translation.rmse, 0.1);
}

Trajectory moved(Trajectory trajectory, const Pose& other_from_world) {
  for (StampedPose& sample : trajectory) sample.world_from_body = other_from_world * sample.world_from_body;
  return trajectory;
}

TEST(EvaluationReport, AlignsTheFirstPoseOnRequest) {
  const Pose elsewhere{rotation_exp({0.1, 0.2, 1.0}), {5.0, -3.0, 1.0}};
  EXPECT_LT(report_of(moved(circle(), elsewhere), PoseAlignment::origin).ate->translation.max, 1e-9);
  Trajectory estimate = circle();
  estimate.front().world_from_body.translation.x() += 0.5;
  const EvaluationReport report = report_of(moved(estimate, elsewhere), PoseAlignment::origin);
  EXPECT_NEAR(report.ate->translation.median, 0.5, 1e-9) << "one bad pose moves all others";
  EXPECT_LT(report.ate->errors.front(), 1e-9);
  EXPECT_THAT(evaluation_report(report, "a", "b").text,
              HasSubstr("alignment    origin: the first pose equals the true one"));
}

// A line of 50 m with lateral sway.
EvaluationReport report_of_line(double sway, double error, PoseAlignment alignment) {
  Trajectory truth, estimate;
  for (int i = 0; i <= 500; ++i) {
    const Eigen::Vector3d place(0.1 * i, sway * std::sin(0.1 * i), 0.0);
    truth.push_back({i * std::chrono::milliseconds(50), {Eigen::Quaterniond::Identity(), place}});
    const Eigen::Vector3d off(0.0, 0.0, error * (i % 2 == 0 ? 1.0 : -1.0));
    estimate.push_back({truth.back().time, {Eigen::Quaterniond::Identity(), place + off}});
  }
  EvaluationProtocol protocol;
  protocol.alignment = alignment;
  return evaluate(estimate, truth, protocol, {}).value();
}

TEST(EvaluationReport, WarnsOfAlignmentsAlongALine) {
  const EvaluationReport thin = report_of_line(0.1, 0.0, PoseAlignment::se3);
  EXPECT_NEAR(thin.true_spread[0], std::sqrt((501.0 * 501.0 - 1.0) / 12.0) * 0.1, 1e-3);
  EXPECT_NEAR(thin.true_spread[1], 0.1 / std::sqrt(2.0), 2e-3);
  EXPECT_THAT(evaluation_report(thin, "a", "b").text,
              HasSubstr("caveat       the path is nearly a line, 14.5 m long "));
  EXPECT_TRUE(nlohmann::json::parse(to_json(evaluation_report(thin, "a", "b")))["is_nearly_a_line"]);
  EXPECT_TRUE(is_nearly_straight(report_of_line(1.0, 0.5, PoseAlignment::se3)))
      << "the errors are as large as the sway";
  EXPECT_FALSE(is_nearly_straight(report_of_line(1.0, 0.01, PoseAlignment::se3)));
  EXPECT_THAT(evaluation_report(report_of_line(0.1, 0.0, PoseAlignment::origin), "a", "b").text,
              Not(HasSubstr("caveat")));
  EXPECT_THAT(evaluation_report(report_of(circle(), PoseAlignment::se3), "a", "b").text, Not(HasSubstr("caveat")));
}

TEST(EvaluationReport, ContainsKittiSegments) {
  EXPECT_THAT(evaluation_report(report_of(circle(), PoseAlignment::se3), "a", "b").text,
              HasSubstr("segments (KITTI)       none, the path is shorter than 100 m\n"));
  Trajectory truth;
  for (int i = 0; i <= 150; ++i) {
    truth.push_back({i * std::chrono::milliseconds(50), {Eigen::Quaterniond::Identity(), {1.0 * i, 0.0, 0.0}}});
  }
  EvaluationProtocol protocol;
  protocol.alignment = PoseAlignment::none;
  const EvaluationReport report = evaluate(scaled(truth, 1.02), truth, protocol, {}).value();
  // Segments begin at poses 0, 10, ... 40 and end at the first pose beyond 100 m: 101 m, 2 % of which is 2.02 m.
  EXPECT_THAT(evaluation_report(report, "a", "b").text,
              HasSubstr("segments (KITTI)          2.0200 %    0.000000 deg/m        5 segments\n"
                        "  of 100 m                2.0200 %    0.000000 deg/m        5 segments\n"));
  const nlohmann::json json = nlohmann::json::parse(to_json(evaluation_report(report, "a", "b")))["segments"];
  EXPECT_NEAR(json["all"]["translation_percent"].get<double>(), 2.02, 1e-9);
  EXPECT_EQ(json["by_length_m"]["100"]["count"], 5);
}

TEST(EvaluationReport, CountsTheFramesGiven) {
  Trajectory estimate = circle();
  estimate.resize(76);
  std::vector<Timestamp> times;
  for (const StampedPose& sample : circle()) times.push_back(sample.time);
  const EvaluationReport report = report_of(estimate, PoseAlignment::se3, ExpectedFrames{times, "frames of room"});
  EXPECT_THAT(evaluation_report(report, "a", "b").text, HasSubstr("coverage     75.2 % (76 of 101 frames of room)\n"));
}

TEST(EvaluationReport, EstimatesTheNumberOfFramesIfNotGiven) {
  Trajectory estimate = circle();
  estimate.resize(76);
  EXPECT_THAT(evaluation_report(report_of(estimate, PoseAlignment::se3), "a", "b").text,
              HasSubstr("coverage     75.2 % (76 of 101 frames expected from the time span of the truth"));
}

TEST(EvaluationReport, ReportsUndefinedFiguresOfOnePose) {
  Trajectory estimate = circle();
  estimate.resize(1);
  const EvaluationReport report = report_of(estimate, PoseAlignment::se3);
  const std::string text = evaluation_report(report, "a", "b").text;
  EXPECT_THAT(text, HasSubstr("alignment    impossible"));
  EXPECT_THAT(text, HasSubstr("coverage     unknown"));
  EXPECT_THAT(text, HasSubstr("RPE 1 s        m       no pair of poses"));
  EXPECT_THAT(text, Not(HasSubstr("ATE")));
  const nlohmann::json json = nlohmann::json::parse(to_json(evaluation_report(report, "a", "b")));
  EXPECT_TRUE(json["ate"].is_null());
  EXPECT_TRUE(json["coverage"].is_null());
  EXPECT_TRUE(json["rpe"]["1_s"]["translation_m"].is_null());
}

TEST(EvaluationReport, ContainsTheSameFiguresInJson) {
  const EvaluationReport report = report_of(scaled(circle(), 1.1), PoseAlignment::none);
  const std::string text = to_json(evaluation_report(report, "out.txt", "truth.csv"));
  EXPECT_THAT(text, StartsWith("{\n  \"protocol\": {\n    \"poses\": \"final\""));
  const nlohmann::json json = nlohmann::json::parse(text);
  EXPECT_EQ(json["protocol"]["alignment"], "none");
  EXPECT_EQ(json["protocol"]["association"]["interpolated_within_s"], 0.06);
  EXPECT_EQ(json["protocol"]["truth_time_offset_s"], 0.0);
  EXPECT_EQ(json["estimate"]["file"], "out.txt");
  EXPECT_EQ(json["pairs"], 101);
  EXPECT_EQ(json["coverage"]["share"], 1.0);
  EXPECT_NEAR(json["ate"]["translation_m"]["rmse"].get<double>(), 0.2, 1e-12);
  EXPECT_EQ(json["ate"]["truth_from_estimate"]["scale"], 1.0);
  EXPECT_EQ(json["rpe"]["1_frame"]["rotation_deg"]["count"], 100);
  EXPECT_EQ(json["rpe"]["1_m"]["translation_m"]["rmse"].get<double>(), report.rpe_metre.translation.rmse);
}

TEST(EvaluationReport, IsEmptyWithoutCommonPoses) {
  Trajectory estimate = circle();
  for (StampedPose& sample : estimate) sample.time += std::chrono::hours(1);
  EXPECT_FALSE(evaluate(estimate, circle(), EvaluationProtocol{}, {}).has_value());
}

}  // namespace
}  // namespace byre
