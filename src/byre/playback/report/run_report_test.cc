#include "byre/playback/report/run_report.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

RunProtocol protocol_of(Pace pace) {
  RunProtocol protocol;
  protocol.options.close_loops = false;
  protocol.recording = "MH_01_easy";
  protocol.range = {.start_s = 1.5, .stride = 2};
  protocol.frames_in_range = 4;
  protocol.recordings = {"MH_01_easy"};
  protocol.options.pace = pace;
  return protocol;
}

PlayedFrame tracked_frame(int number) {
  FrameReport report;
  report.time = milliseconds(50 * number);
  report.state = State::tracking;
  report.map_from_body = Pose{Eigen::Quaterniond::Identity(), {number + 0.25, 0.0, 0.0}};
  report.covariance(0, 5) = 0.5;
  report.covariance(5, 0) = 0.25;
  report.features = 900;
  report.expected_points = 400;
  report.matches = 300;
  report.inliers = 250;
  report.keyframe_added = number == 0;
  if (number == 2) report.job_seconds = 0.0305;
  StageSeconds seconds;
  seconds.decode = 0.004;
  seconds.stereo = 0.002;
  seconds.map_submit = 0.001;
  seconds.total = 0.010 + 0.001 * number;
  return {report.time, true, false, report, seconds, 1 + number, 500 * number, 60.04 + number};
}

// Four frames, the second unreadable.
RunResult small_map_run() {
  RunResult run;
  for (int i = 0; i < 4; ++i) run.frames.push_back(tracked_frame(i));
  run.frames[1].report.reset();
  run.frames[1].has_right = false;
  for (const int i : {0, 2, 3})
    run.final.push_back(
        {run.frames[static_cast<std::size_t>(i)].time, *run.frames[static_cast<std::size_t>(i)].report->map_from_body});
  run.causal = run.final;
  run.stored.map.add_keyframe({});
  for (int i = 0; i < 1234; ++i) run.stored.map.add_point({});
  run.job_seconds = {0.0305, 0.0105};
  run.warnings = {"2.png: is not a whole image"};
  run.wall_seconds = 2.0;
  return run;
}

json stats_of(const RunResult& run, Pace pace = Pace::paced) {
  return json::parse(to_json(run_report(run, protocol_of(pace), {1.5, 64.0}), run));
}

TEST(MapJson, BeginsWithTheProtocol) {
  const json protocol = stats_of(small_map_run()).at("protocol");
  EXPECT_EQ(protocol.at("recording"), "MH_01_easy");
  EXPECT_EQ(protocol.at("format"), "euroc");
  EXPECT_EQ(protocol.at("pace"), "paced");
  EXPECT_EQ(protocol.at("mapping_latency_frames"), kPacedLatency);
  EXPECT_EQ(protocol.at("version"), BYRE_VERSION);
  EXPECT_EQ(protocol.at("range").at("start_s"), 1.5);
  EXPECT_TRUE(protocol.at("range").at("end_s").is_null());
  EXPECT_EQ(protocol.at("range").at("stride_frames"), 2);
  EXPECT_EQ(protocol.at("options").at("max_features"), ExtractOptions{}.max_features);
}

TEST(MapJson, CountsFramesByResult) {
  const json counts = stats_of(small_map_run()).at("counts");
  EXPECT_EQ(counts.at("frames"), 4);
  EXPECT_EQ(counts.at("frames_with_pose"), 3);
  EXPECT_EQ(counts.at("coverage"), 0.75);
  EXPECT_EQ(counts.at("frames_unreadable"), 1);
  EXPECT_EQ(counts.at("keyframes_made"), 1);
  EXPECT_EQ(counts.at("points"), 1234);
}

TEST(MapJson, SummarisesTimesInMilliseconds) {
  const json stats = stats_of(small_map_run());
  EXPECT_EQ(stats.at("frame_thread_ms").at("mean"), 11.667);
  EXPECT_EQ(stats.at("frame_thread_ms").at("max"), 13.0);
  EXPECT_EQ(stats.at("stages_ms").at("stereo").at("p99"), 2.0);
  EXPECT_EQ(stats.at("mapping_jobs"), (json{{"count", 2}, {"mean_ms", 20.5}, {"max_ms", 30.5}}));
  EXPECT_EQ(stats.at("cpu_s"), 1.5);
  EXPECT_EQ(stats.at("wall_s"), 2.0);
  EXPECT_EQ(stats.at("peak_memory_mb"), 64.0);
}

TEST(MapJson, ReportsFrameTimesWithoutJobsOnTheSameThread) {
  EXPECT_EQ(stats_of(small_map_run(), Pace::same_thread).at("frame_thread_without_jobs_ms").at("max"), 12.0);
  EXPECT_FALSE(stats_of(small_map_run()).contains("frame_thread_without_jobs_ms"));
}

TEST(MapJson, ReportsLateFramesWhenLive) {
  RunResult run = small_map_run();
  run.lateness = {0.002, 0.0405};
  EXPECT_EQ(stats_of(run, Pace::live).at("late"), (json{{"frames", 2}, {"max_ms", 40.5}}));
  EXPECT_FALSE(stats_of(run).contains("late"));
}

TEST(MapJson, ReportsFinishingAndTheExtendedMap) {
  RunProtocol protocol = protocol_of(Pace::paced);
  protocol.extended = "barn.byre";
  RunResult run = small_map_run();
  run.finishing.emplace().report.loops = 0;
  const json stats = json::parse(to_json(run_report(run, protocol, {}), run));
  EXPECT_EQ(stats.at("finishing").at("cut_short"), false);
  EXPECT_EQ(stats.at("extension").at("frames_until_found"), 0);
  EXPECT_EQ(stats.at("extension").at("recordings"), (json{{{"name", "MH_01_easy"}, {"keyframes", 1}}}));
  EXPECT_TRUE(stats_of(small_map_run()).at("finishing").is_null());
  EXPECT_TRUE(stats_of(small_map_run()).at("extension").is_null());
}

TEST(MapJson, ContainsEveryFrame) {
  const json frames = stats_of(small_map_run()).at("frames");
  ASSERT_EQ(frames.size(), 4u);
  const json& frame = frames[2];
  EXPECT_EQ(frame.at("time_s"), 0.1);
  EXPECT_EQ(frame.at("state"), "tracking");
  EXPECT_EQ(frame.at("keyframe"), false);
  EXPECT_EQ(frame.at("features"), 900);
  EXPECT_EQ(frame.at("expected"), 400);
  EXPECT_EQ(frame.at("matches"), 300);
  EXPECT_EQ(frame.at("inliers"), 250);
  EXPECT_EQ(frame.at("map_keyframes"), 3);
  EXPECT_EQ(frame.at("map_points"), 1000);
  EXPECT_EQ(frame.at("memory_mb"), 62.0);
  EXPECT_EQ(frame.at("position_m"), (json{2.25, 0.0, 0.0}));
  EXPECT_EQ(frame.at("quaternion_xyzw"), (json{0.0, 0.0, 0.0, 1.0}));
  ASSERT_EQ(frame.at("body_covariance").size(), 36u);
  EXPECT_EQ(frame.at("body_covariance")[5], 0.5);
  EXPECT_EQ(frame.at("body_covariance")[30], 0.25);
  EXPECT_EQ(frame.at("ms").at("decode"), 4.0);
  EXPECT_EQ(frame.at("ms").at("total"), 12.0);
  EXPECT_EQ(frame.at("ms").at("job_taken_over"), 30.5);
  EXPECT_TRUE(frames[0].at("ms").at("job_taken_over").is_null());
}

TEST(MapJson, ContainsHealthAndOdometryOfEveryFrame) {
  RunResult run = small_map_run();
  FrameReport& report = *run.frames[2].report;
  report.odometry_from_body = Pose{Eigen::Quaterniond::Identity(), {0.0, 1.5, 0.0}};
  report.odometry_covariance(0, 1) = 0.125;
  report.health.verdict = Verdict::degraded;
  report.health.doubt = DistrustReason::maps_disagree;
  report.health.offline_inliers = 77;
  report.health.position_sigma = 0.5;
  report.health.agreement = Agreement{0.25, 0.125};
  const json frames = stats_of(run).at("frames");
  EXPECT_EQ(frames[2].at("odometry").at("position_m"), (json{0.0, 1.5, 0.0}));
  EXPECT_EQ(frames[2].at("odometry").at("body_covariance")[1], 0.125);
  const json& health = frames[2].at("health");
  EXPECT_EQ(health.at("verdict"), "degraded");
  EXPECT_EQ(health.at("doubt"), "offline and online points disagree");
  EXPECT_EQ(health.at("offline_inliers"), 77);
  EXPECT_EQ(health.at("position_sigma_m"), 0.5);
  EXPECT_EQ(health.at("agreement"), (json{{"translation_m", 0.25}, {"rotation_rad", 0.125}}));
  EXPECT_TRUE(health.at("image").is_null());
  EXPECT_FALSE(frames[0].contains("odometry"));
  EXPECT_FALSE(frames[2].contains("error")) << "there is no truth";
}

TEST(MapJson, ContainsTheMissionAndTheErrorOfEachPose) {
  MissionOutcome mission;
  mission.statistics.losses = 3;
  mission.errors.emplace().causal = {{milliseconds(100), Vector6::Unit(1)}};
  RunProtocol protocol = protocol_of(Pace::paced);
  protocol.offline = "barn.byre";
  protocol.options.session.map_online = false;
  const json stats = json::parse(to_json(run_report(small_map_run(), protocol, {}, mission), small_map_run(), mission));
  EXPECT_EQ(stats.at("protocol").at("offline_map"), "barn.byre");
  EXPECT_EQ(stats.at("protocol").at("localise_only"), true);
  EXPECT_EQ(stats.at("mission").at("losses"), 3);
  EXPECT_EQ(stats.at("errors").at("causal").at("count"), 1);
  EXPECT_EQ(stats.at("frames")[2].at("error").at("position_m"), 1.0);
  EXPECT_FALSE(stats.at("frames")[3].contains("error"));
  EXPECT_FALSE(stats_of(small_map_run()).contains("mission"));
}

TEST(MapJson, ContainsUnreadableFrames) {
  const json frame = stats_of(small_map_run()).at("frames")[1];
  EXPECT_EQ(frame.at("state"), "unreadable");
  EXPECT_EQ(frame.at("time_s"), 0.05);
  EXPECT_FALSE(frame.contains("position_m"));
}

TEST(MapJson, ListsTheFirstTwentyWarnings) {
  RunResult run = small_map_run();
  run.warnings.assign(45, "torn");
  const json warnings = stats_of(run).at("warnings");
  EXPECT_EQ(warnings.at("count"), 45);
  EXPECT_EQ(warnings.at("first").size(), 20u);
}

TEST(MapJson, EscapesControlCharactersOfNames) {
  RunProtocol protocol = protocol_of(Pace::paced);
  protocol.recording =
      "walk\xc2\x9b"
      "2J\x7f.bag";
  const std::string text = to_json(run_report(small_map_run(), protocol, {}), small_map_run());
  EXPECT_THAT(text, HasSubstr(R"(walk\u009b2J\u007f.bag)"));
  EXPECT_EQ(json::parse(text).at("protocol").at("recording"), protocol.recording);
}

TEST(MapJson, IsCompleteForARunWithoutFrames) {
  const json stats = stats_of({});
  EXPECT_EQ(stats.at("frames"), json::array());
  EXPECT_EQ(stats.at("stopped_early"), true);
  EXPECT_TRUE(stats.at("frame_thread_ms").is_null());
  EXPECT_EQ(stats.at("counts").at("coverage"), 0.0);
}

TEST(MapText, SummarisesTheRun) {
  const std::string text = to_text(run_report(small_map_run(), protocol_of(Pace::paced), {1.5, 64.0}), true);
  EXPECT_THAT(text, HasSubstr("recording    MH_01_easy, 4 frames\n"));
  EXPECT_THAT(text, HasSubstr("poses        3 of 4 frames (75.0 %); 1 could not be read\n"));
  EXPECT_THAT(text, HasSubstr("map          1 keyframes left of 1 made; 1234 points\n"));
  EXPECT_THAT(text, HasSubstr("path         3.00 m, through 3 final poses\n"));
  EXPECT_THAT(text, HasSubstr("frame time   mean 11.7 ms, p99 13.0 ms\n"));
  EXPECT_THAT(text, HasSubstr("mapping      2 jobs, mean 20.5 ms, max 30.5 ms\n"));
  EXPECT_THAT(text, HasSubstr("CPU time     1.5 s, in 2.0 s of wall time: 2.0 frames/s\n"));
  EXPECT_THAT(text, HasSubstr("memory       peak 64 MB; 60 MB after the first frame, 63 MB after the last\n"));
  EXPECT_THAT(text, HasSubstr("warnings     1; the first: 2.png: is not a whole image\n"));
  EXPECT_THAT(text, HasSubstr("finishing    skipped (--no-loops)\n"));
  EXPECT_THAT(text, Not(HasSubstr("late")));
  EXPECT_THAT(text, Not(HasSubstr("extended")));
}

TEST(MapText, ReportsFramesThatWereNotJoined) {
  RunResult run = small_map_run();
  run.not_joined = {run.frames[2].time, run.frames[3].time};
  const std::string text = to_text(run_report(run, protocol_of(Pace::paced), {}), false);
  EXPECT_THAT(text, HasSubstr("not joined   2 frames, 0.1 to 0.1 s:"));
  EXPECT_EQ(stats_of(run).at("counts").at("frames_not_joined"), 2);
}

TEST(MapText, ReportsChangesByFinishing) {
  RunResult run = small_map_run();
  run.finishing.emplace().report.points_removed = 12;
  EXPECT_THAT(to_text(run_report(run, protocol_of(Pace::paced), {}), true),
              HasSubstr("removed      0 redundant keyframes, 12 weak points\n"));
}

TEST(MapText, ReportsTheRecordingsOfAnExtendedMap) {
  RunProtocol protocol = protocol_of(Pace::paced);
  protocol.extended = "barn.byre";
  protocol.recordings = {"MH_01_easy", "MH_02_easy"};
  RunResult run = small_map_run();
  Keyframe keyframe;
  keyframe.recording = 1;
  for (int i = 0; i < 2; ++i) run.stored.map.add_keyframe(keyframe);
  run.frames.front().report->map_from_body.reset();
  const std::string text = to_text(run_report(run, protocol, {}), true);
  EXPECT_THAT(text, HasSubstr("extended     barn.byre, localised in it after 2 frames\n"));
  EXPECT_THAT(text, HasSubstr("map          3 keyframes left of the extended map and 1 made; 1234 points\n"));
  EXPECT_THAT(text, HasSubstr("of           MH_01_easy, 1 keyframes\nof           MH_02_easy, 2 keyframes\n"));
}

TEST(MapText, ReportsTheMission) {
  MissionOutcome mission;
  mission.statistics.seconds_to_first_pose = 0.1;
  const std::string text = to_text(run_report(small_map_run(), protocol_of(Pace::paced), {}, mission), true);
  EXPECT_THAT(text, HasSubstr("poses        3 of 4 frames (75.0 %), the first after 0.10 s\n"));
  EXPECT_THAT(text, HasSubstr("verdicts     trusted "));
  EXPECT_THAT(text, HasSubstr("finishing    skipped")) << "as without an offline map";
  EXPECT_THAT(text, Not(HasSubstr("truth"))) << "there is none";
}

TEST(MapText, ReportsInterruptionAndLateFrames) {
  RunResult run = small_map_run();
  run.frames.pop_back();
  run.lateness = {0.0405};
  const std::string text = to_text(run_report(run, protocol_of(Pace::live), {}), true);
  EXPECT_THAT(text, HasSubstr("4 frames, stopped after 3\n"));
  EXPECT_THAT(text, HasSubstr("late         1 frames, at most 40.5 ms\n"));
}

}  // namespace
}  // namespace byre
