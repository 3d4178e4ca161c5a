#include "byre/benchmark/demo/demo_run.h"

#include "byre/base/stopwatch.h"
#include "byre/benchmark/demo/animation.h"
#include "byre/benchmark/demo/plan_pane.h"
#include "byre/benchmark/demo/table.h"
#include "byre/benchmark/measures.h"
#include "byre/features/image_threads.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/archive/register_map.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"
#include "byre/trajectory_file.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr int kStages = 6;

// Result of the first visit.
struct FirstVisit {
  StoredMap stored;  // registered on the plan
  FloorPlan plan;
  Trajectory path;
};

CowshedRecordingOptions visit_options(const DemoOptions& options, int mission) {
  constexpr double kMoved = 0.5;         // share of things moved between visits
  constexpr double kSecondVisit = 1.25;  // duration relative to the first visit, for the way into the store
  constexpr double kSecondStart = 0.8;   // share of the lap: on the way back, where the map sees the other direction
  CowshedRecordingOptions visit;
  visit.barn.seed = options.seed;
  visit.barn.mission = mission;
  visit.barn.change = kMoved;
  if (mission != 1) visit.start = kSecondStart;
  visit.duration_s = mission == 1 ? options.duration_s : kSecondVisit * options.duration_s;
  visit.frame_rate_hz = options.frame_rate_hz;
  visit.image_divisor = options.image_divisor;
  return visit;
}

// Time spans in the store, which the first visit did not see; from the first frame.
std::vector<TimeSpan> spans_off_the_map(const Trajectory& truth) {
  std::vector<TimeSpan> spans;
  bool was_off = false;
  for (const StampedPose& sample : truth) {
    const double time_s = to_seconds(sample.time - truth.front().time);
    const bool is_off = sample.world_from_body.translation.x() > kCowshedSize.length;
    if (is_off && !was_off) spans.push_back({time_s, time_s});
    if (is_off) spans.back().end_s = time_s;
    was_off = is_off;
  }
  return spans;
}

Eigen::Vector2d on_floor(const Eigen::Vector3d& position) {
  return position.head<2>();
}

std::vector<DemoMoment> moments_of(const RunResult& run, const std::vector<TracePoint>& trace,
                                   const Trajectory& truth) {
  std::vector<DemoMoment> moments;
  auto traced = trace.begin();
  for (const PlayedFrame& frame : run.frames) {
    const std::optional<Pose> true_pose = pose_at(truth, frame.time, AssociationOptions{}.max_gap);
    if (!frame.report || !true_pose) continue;
    const Health& health = frame.report->health;
    moments.push_back({.time_s = to_seconds(frame.time - run.frames.front().time),
                       .has_pose = frame.report->map_from_body.has_value(),
                       .verdict = health.verdict,
                       .offline_inliers = health.offline_inliers,
                       .online_inliers = health.online_inliers,
                       .position_sigma = health.position_sigma,
                       .truth = on_floor(true_pose->translation)});
    while (traced != trace.end() && traced->time < frame.time) ++traced;
    if (traced == trace.end() || traced->time != frame.time) continue;
    moments.back().position = on_floor(traced->position_in_truth);
    moments.back().error = traced->error;
  }
  return moments;
}

// alignment: of the map to the truth; empty without a map, then the path is aligned to the truth.
DemoArm evaluate_arm(Arm arm, const RunResult& run, const std::optional<MapAlignment>& alignment,
                     const Trajectory& truth) {
  const RunTruth run_truth{truth, alignment};
  return {arm, evaluate_run(run, run_truth), moments_of(run, trace_of(run.causal, run_truth), truth)};
}

std::vector<Eigen::Vector2d> corners_of(const MovableObject& object) {
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2f& corner : footprint_of(object)) corners.emplace_back(corner.cast<double>());
  return corners;
}

std::vector<MovedThing> moved_things(const CowshedOptions& before, const CowshedOptions& after) {
  const std::vector<MovableObject> by_day = build_cowshed(before).objects;
  const std::vector<MovableObject> now = build_cowshed(after).objects;
  std::vector<MovedThing> moved;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (by_day[i].position != now[i].position) moved.push_back({corners_of(by_day[i]), corners_of(now[i])});
  }
  return moved;
}

class DemoRunner {
 public:
  DemoRunner(const DemoOptions& options, const DemoHooks& hooks)
      : options_(options), hooks_(hooks), vocabulary_(open_vocabulary(options.vocabulary)) {}

  std::optional<DemoFindings> run() {
    const Stopwatch watch;
    for (const int mission : {1, 2}) {
      if (!hooks_.should_stop()) render(mission);
    }
    if (!hooks_.should_stop()) map_first_visit();
    for (const Arm arm : {Arm::hybrid, Arm::no_map, Arm::localise_only}) {
      if (!hooks_.should_stop()) run_arm(arm);
    }
    if (hooks_.should_stop()) return std::nullopt;
    findings_.mission_picture = mission_picture(place_, findings_.arms);
    findings_.total_s = watch.seconds();
    return std::move(findings_);
  }

 private:
  fs::path visit(int mission) const { return options_.output / (mission == 1 ? "first_visit" : "second_visit"); }

  void tell(const std::string& what) { hooks_.before_stage(fmt::format("{} of {}: ", ++stage_, kStages) + what); }

  void render(int mission) {
    tell(mission == 1 ? "rendering the first visit, by day" : "rendering the second visit, at dusk");
    const Rendering rendering = hooks_.render(visit_options(options_, mission), visit(mission));
    findings_.rendering_s += rendering.preparing_s + rendering.rendering_s;
  }

  Slam make_slam(Arm arm, const Recording& recording) const {
    MethodOptions method;
    method.session.map_online = arm != Arm::localise_only;
    SlamOptions slam = slam_options(method);
    slam.vocabulary = options_.vocabulary;
    slam.recording = visit(barn_.stored.plan ? 2 : 1).filename().string();
    slam.site = "simulated cowshed";
    return arm == Arm::no_map ? Slam::mapping(recording.calibration(), slam)
                              : Slam::on_map(recording.calibration(), map_file(), slam);
  }

  void map_first_visit() {
    tell("mapping the first visit, and registering the map on the floor plan");
    const std::unique_ptr<Recording> recording = open_recording(visit(1), {});
    Slam slam = make_slam(Arm::no_map, *recording);
    RunResult run = hooks_.play(slam, *recording, {});
    if (hooks_.should_stop()) return;
    if (run.causal.empty()) throw std::runtime_error("no frame of the first visit got a pose");
    write_trajectories(run, "first_visit");
    findings_.map_frames = static_cast<int>(run.frames.size());
    findings_.map_ate = evaluate_run(run, {load_truth(visit(1)), {}}).final_poses.ate.value_or(0.0);
    barn_.path = run.final;
    barn_.stored = std::move(run.stored);
    lay_on_plan();
  }

  void lay_on_plan() {
    const fs::path folder = visit(1) / "plan";
    barn_.plan = read_floor_plan(folder / "plan.yaml");
    const Registering registering = register_map(barn_.stored, map_file(), barn_.plan, folder / "picks.csv", {});
    barn_.stored.plan = registering.fit.registration;
    save_for_missions(barn_.stored, vocabulary_, "simulated cowshed", map_file());
    findings_.map_keyframes = barn_.stored.map.keyframe_count();
    findings_.map_points = barn_.stored.map.point_count();
    findings_.picks = static_cast<int>(registering.correspondences.size());
  }

  void run_arm(Arm arm) {
    tell("the second visit: " + shown_name(arm));
    const std::unique_ptr<Recording> recording = open_recording(visit(2), {});
    const Trajectory truth = load_truth(visit(2));
    const int every_for_film = options_.animation ? (recording->size() + kAnimationFrames - 1) / kAnimationFrames : 0;
    DemoPainter painter(recording->calibration(), every_for_film);
    PlayHooks hooks;
    if (arm == Arm::hybrid) hooks.on_frame = [&painter](const RunView& view) { painter.add(view); };
    Slam slam = make_slam(arm, *recording);
    const RunResult run = hooks_.play(slam, *recording, hooks);
    if (hooks_.should_stop()) return;
    write_trajectories(run, std::string(name_of(arm)));
    std::optional<MapAlignment> alignment;
    if (arm != Arm::no_map) alignment = MapAlignment{barn_.stored.plan->plan_from_map, 0};
    findings_.arms.push_back(evaluate_arm(arm, run, alignment, truth));
    if (arm != Arm::hybrid) return;
    findings_.off_the_map = spans_off_the_map(truth);
    draw(painter);
  }

  void draw(const DemoPainter& painter) {
    PlanScene scene;
    scene.title = "simulated cowshed";
    scene.ground = place_.ground = ground_of(barn_.stored, barn_.plan);
    scene.map = scene_of(barn_.stored.map);
    scene.paths.push_back({"first visit", barn_.path, {}});
    findings_.plan_picture = painter.plan_picture(std::move(scene));
    findings_.camera_s = painter.camera_s();
    if (findings_.camera_s) findings_.camera_picture = painter.camera_picture();
    const DemoArm& hybrid = findings_.arms.back();
    place_.shown = ground_around(hybrid.moments);
    place_.unmapped = {Eigen::Vector2d(kCowshedSize.length, -kCowshedSize.store_half_width),
                       Eigen::Vector2d(kCowshedSize.length + kCowshedSize.store_length, kCowshedSize.store_half_width)};
    place_.labels = {{{24.0, -0.1}, "barn, mapped by day"}, {{35.0, 2.6}, "feed store, not on the map"}};
    place_.moved = moved_things(visit_options(options_, 1).barn, visit_options(options_, 2).barn);
    if (painter.film().empty()) return;
    findings_.animation = animation_of(place_, hybrid, painter.film());
  }

  void write_trajectories(const RunResult& run, const std::string& name) const {
    const fs::path folder = options_.output / "trajectories";
    fs::create_directories(folder);
    write_trajectory(run.causal, folder / (name + ".published.txt"));
    write_trajectory(run.final, folder / (name + ".final.txt"));
  }

  fs::path map_file() const { return options_.output / "barn.byre"; }

  // Constant after construction; options and hooks are borrowed.
  const DemoOptions& options_;
  const DemoHooks& hooks_;
  const Vocabulary vocabulary_;

  int stage_ = 0;
  FirstVisit barn_;  // set once the first visit is mapped
  DemoPlace place_;  // set after the hybrid run
  DemoFindings findings_;
};

}  // namespace

std::optional<DemoFindings> run_demo(const DemoOptions& options, const DemoHooks& hooks) {
  limit_image_threads(1);
  return DemoRunner(options, hooks).run();
}

}  // namespace byre
