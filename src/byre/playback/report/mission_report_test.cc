#include "byre/playback/report/mission_report.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

MissionStatistics small_mission() {
  MissionStatistics statistics;
  statistics.frames = 200;
  statistics.trusted = 190;
  statistics.degraded = 6;
  statistics.untrusted = 4;
  statistics.doubts = {{DistrustReason::few_offline_points, 5},
                       {DistrustReason::no_pose, 3},
                       {DistrustReason::clustered, 1},
                       {DistrustReason::blinded, 1}};
  statistics.seconds_to_first_pose = 0.25;
  statistics.losses = 2;
  statistics.relocalisations = 2;
  statistics.navigation_errors = 1;
  statistics.in_mapped_area = {3, 1.5};
  statistics.offline_inliers = summarise({120.0});
  statistics.online_inliers = summarise({30.0});
  statistics.max_suspended = 17;
  return statistics;
}

PoseError off_by(double metres) {
  PoseError error;
  error.delta.x() = metres;
  return error;
}

MissionErrors small_errors() {
  MissionErrors errors;
  errors.in_map_frame = true;
  errors.alignment_poses = 12;
  errors.causal = {off_by(0.01), off_by(0.01), off_by(0.25)};
  errors.trusted = {off_by(0.01), off_by(0.25)};
  errors.final = {off_by(0.005)};
  errors.wrongly_trusted = 1;
  errors.within_bound = 2.0 / 3.0;
  errors.map = {off_by(0.02)};
  errors.within_bound_without_map_error = 0.95;
  return errors;
}

TEST(MissionText, SummarisesVerdictsAndMainDoubts) {
  const std::string text = to_text(mission_report(small_mission()), true);
  EXPECT_THAT(text, HasSubstr("verdicts     trusted 95.0 %, degraded 3.0 %, untrusted 2.0 % of 200 frames\n"));
  EXPECT_THAT(text, HasSubstr("doubts       too few offline points 5, no pose 3, points are clustered 1 frames\n"));
  EXPECT_THAT(text, HasSubstr("lost         2 times, relocalised 2 times; 1 navigation errors\n"));
}

TEST(MissionText, CountsMissingFramesAmongTheOthers) {
  MissionStatistics statistics = small_mission();
  statistics.frames = 1000;
  statistics.missing = 800;
  const std::string text = to_text(mission_report(statistics), true);
  EXPECT_THAT(
      text,
      HasSubstr("verdicts     trusted 19.0 %, degraded 0.6 %, untrusted 0.4 %, missing 80.0 % of 1000 frames\nmissing  "
                "    800 of 1000 frames could not be read: too many for verdict shares to describe the mission\n"));
  EXPECT_EQ(mission_report(statistics).figures.at("frames_missing"), 800);
  EXPECT_EQ(mission_report(statistics).figures.at("is_full_of_gaps"), true);
  EXPECT_THAT(mission_report(small_mission()).text, Not(HasSubstr("missing")));
}

TEST(MissionText, ReportsKeyframesOfVisitedPlaces) {
  const std::string text = to_text(mission_report(small_mission()), true);
  EXPECT_THAT(text, HasSubstr("keyframes    2.0 per minute in known places (3 in 90 s)\n"));
  EXPECT_THAT(text, Not(HasSubstr("changed or new")));
  EXPECT_THAT(text, HasSubstr("inliers      offline median 120, online 30; up to 17 offline points suspended\n"));
}

TEST(MissionText, ReportsDirt) {
  EXPECT_THAT(mission_report(small_mission()).text, Not(HasSubstr("dirt")));
  MissionStatistics statistics = small_mission();
  statistics.frames_with_dirt = 40;
  statistics.max_hidden = 0.12;
  EXPECT_THAT(mission_report(statistics).text,
              HasSubstr("dirt         dirt hides 12 % of the left image: clean the lens (maximum; 40 frames)\n"));
  EXPECT_EQ(mission_report(statistics).figures.at("most_hidden"), 0.12);
}

TEST(MissionText, ReportsErrorsInTheMapFrameAndOfTrustedFrames) {
  const std::string text = mission_error_report(small_errors()).text;
  EXPECT_THAT(text, HasSubstr("truth        aligned to the map by 12 poses of the run that made the map\n"));
  EXPECT_THAT(text, HasSubstr("causal       RMSE 0.1446 m"));
  EXPECT_THAT(text, HasSubstr("max 0.0050 m\n"));
  EXPECT_THAT(text, HasSubstr("wrong trust  1 trusted frames with an error above 0.2 m, longest 0.00 s\n"));
  EXPECT_THAT(
      text,
      HasSubstr("covariance   66.7 % of causal positions within its 95 % bound, 95.0 % without the map's own error\n"));
  EXPECT_THAT(text, HasSubstr("map          RMSE 0.0200 m"));
}

TEST(MissionText, ReportsAlignmentAndMissingTruth) {
  const std::string text = mission_error_report(MissionErrors{}).text;
  EXPECT_THAT(text, HasSubstr("truth        causal and final poses are aligned to it separately\n"));
  EXPECT_THAT(text, HasSubstr("final        no pose with truth\n"));
  EXPECT_THAT(text, Not(HasSubstr("wrong trust")));
  EXPECT_THAT(text, Not(HasSubstr("map  ")));
}

TEST(MissionJson, ContainsEveryFigureByName) {
  const json mission = mission_report(small_mission()).figures;
  EXPECT_EQ(mission.at("trusted_share"), 0.95);
  EXPECT_EQ(mission.at("doubts").at("too few offline points"), 5);
  EXPECT_EQ(mission.at("doubts").size(), 4u);
  EXPECT_EQ(mission.at("seconds_to_first_pose"), 0.25);
  EXPECT_EQ(mission.at("in_known_places").at("keyframes_per_minute"), 2.0);
  const json errors = mission_error_report(small_errors()).figures;
  EXPECT_EQ(errors.at("causal").at("count"), 3);
  EXPECT_EQ(errors.at("causal_trusted").at("position_m").at("max"), 0.25);
  EXPECT_EQ(errors.at("trusted_off_by_more_than_0.2m"), 1);
  EXPECT_EQ(errors.at("map").at("position_m").at("max"), 0.02);
  EXPECT_EQ(errors.at("share_within_95_percent_bound_beside_map"), 0.95);
  EXPECT_TRUE(mission_error_report(MissionErrors{}).figures.at("share_within_95_percent_bound").is_null());
  EXPECT_TRUE(mission_error_report(MissionErrors{}).figures.at("share_within_95_percent_bound_beside_map").is_null());
}

}  // namespace
}  // namespace byre
