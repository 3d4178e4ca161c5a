#include "byre/slam/session/session.h"

#include "byre/base/stopwatch.h"
#include "byre/geometry/finite.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace byre {
namespace {

// Keyframe with the most similar view: the least sum of its distance, in map units, and the angle between the viewing
// directions, in radians. Empty for an empty map.
std::optional<KeyframeId> keyframe_with_similar_view(const MapGraph& map, const Pose& camera_from_world) {
  const std::vector<KeyframeId> ids = map.keyframe_ids();
  const auto difference = [&](KeyframeId id) {
    const Pose apart = camera_from_world * inverse(map.keyframe_header(id)->camera_from_world);
    return apart.translation.norm() + std::acos(std::clamp(apart.rotation.toRotationMatrix()(2, 2), -1.0, 1.0));
  };
  const auto most_similar = std::ranges::min_element(ids, {}, difference);
  return most_similar != ids.end() ? std::optional(*most_similar) : std::nullopt;
}

// A monocular map begins with the points of two views, which a moving camera loses within a few frames.
bool needs_points_soon(const RobotState& state, int min_tracked) {
  constexpr int kYoung = 10;  // keyframes
  const int keyframes = state.mapper.online().keyframe_count();
  const bool is_young = !state.mission && !state.rig.is_stereo() && keyframes > 0 && keyframes < kYoung;
  return is_young && static_cast<int>(state.seen.size()) < min_tracked;
}

}  // namespace

// Corrections of the whole map and place searches share an executor, because a mission has only the latter.
Executor& SessionExecutors::of(JobKind kind) const {
  switch (kind) {
    case JobKind::local:
      return *local;
    case JobKind::index:
      return *index;
    case JobKind::calibration:
      return *calibration;
    case JobKind::whole_map:
    case JobKind::place_search:
      break;
  }
  return *global;
}

void Session::continue_map(MapGraph online) {
  assert(state_.pose_filter.trajectory().empty());
  state_.mapper.continue_map(std::move(online));
  state_.status = State::lost;
}

void Session::refine_calibration(const Calibration& given, const SelfCalibrationOptions& options) {
  state_.mission ? state_.mission->refine_calibration(given, options.prior_sigmas)
                 : state_.mapper.refine_calibration(given, options);
  refine_readout(RefinedCalibration{given});
}

void Session::refine_readout(const RefinedCalibration& known) {
  assert(state_.pose_filter.trajectory().empty());
  state_.rolling_shutter.refine(known);
}

std::optional<RefinedCalibration> Session::self_calibration() const {
  std::optional<RefinedCalibration> refined;
  if (state_.mapper.calibrator()) {
    refined = state_.mapper.calibrator()->result();
  } else if (state_.mission && state_.mission->calibrator()) {
    refined = state_.mission->calibrator()->result();
  }
  return state_.rolling_shutter.refined(refined);
}

Session::KnownCameras Session::known_cameras() const {
  KnownCameras known{state_.rig, {}, state_.rolling_shutter};
  if (state_.mission && state_.mission->calibrator()) {
    known.calibrator = state_.mission->calibrator();
    known.calibrator->job().abandon();  // its job stays with this session
  }
  return known;
}

void Session::continue_cameras(KnownCameras known) {
  assert(state_.mission && state_.pose_filter.trajectory().empty());
  state_.rolling_shutter = std::move(known.rolling_shutter);
  if (known.calibrator) state_.mission->continue_calibration(*std::move(known.calibrator));
}

double Session::log_odds_of_place() const {
  const bool is_placed = state_.pose_filter.has_pose() && state_.is_registered();
  return is_placed ? state_.pose_filter.place().log_odds_to_rivals() : kNoRivals;
}

FrameReport Session::process(const Frame& rectified, const std::optional<BodyMotion>& motion, FrameBudget* budget) {
  deliver_results(&Executor::collect, needs_points_soon(state_, options_.keyframes.min_tracked)
                                          ? &Executor::collect_early
                                          : &Executor::collect);
  Step now = step(state_, {rectified, motion, tilt_, budget}, options_);
  const Stopwatch submitting;
  run(std::move(now.jobs));
  now.report.map_seconds += submitting.seconds();
  return now.report;
}

void Session::run(std::vector<JobRequest> requests) {
  for (JobRequest& request : requests) executors_.of(request.kind).submit(std::move(request.job));
}

void Session::deliver_results(Take take, Take take_local) {
  const JobKind global = state_.mission ? JobKind::place_search : JobKind::whole_map;
  for (const JobKind kind : {JobKind::local, JobKind::index, global, JobKind::calibration}) {
    try {
      const Take take_result = kind == JobKind::local ? take_local : take;
      if (auto finished = (executors_.of(kind).*take_result)()) deliver(kind, *std::move(finished), state_);
    } catch (...) {
      state_.job(kind)->abandon();
      throw;
    }
  }
}

void Session::finish() {
  state_.pose_filter.apply_length_changes(state_.mapper.finish([this] {
    run(take_requests(state_));
    deliver_results(&Executor::finish, &Executor::finish);
  }));
  state_.pose_filter.apply_length_changes(state_.mapper.join_submaps());
}

FinishReport Session::finish_map(const FinishHooks& hooks) {
  // Matches of a map with a wrong focal length fit it, so that one refinement may give only half of its error.
  constexpr int kMaxRuns = 4;
  FinishReport report;
  for (int run = 1; run <= kMaxRuns; ++run) {
    const auto rotation = state_.mapper.calibrate_finally(state_.rig, hooks.should_stop);
    if (run > 1 && !rotation) break;
    if (rotation) {
      state_.rig = rotation->after;
      state_.pose_filter.rotate_rig(*rotation, state_.mapper.online());
    }
    const FinishReport finished = state_.mapper.finish_map(hooks);
    state_.pose_filter.apply_length_changes(finished.length_changes);
    if (run == 1) {
      report = finished;
    } else {
      report.add(finished);
    }
    if (hooks.should_stop && hooks.should_stop()) break;
  }
  return report;
}

// Tracks from the prediction, else from matches anywhere in the image. A pose far from the prediction is a look-alike.
std::optional<Pose> Session::locate_in_finished_map(const Frame& rectified, const Pose& predicted) {
  constexpr double kFarthest = 0.5;  // from the prediction: share of the median depth, and radians
  const Frame frame = state_.mapper.corrected(rectified);
  const Pose camera = camera_pose(state_.rig, predicted);
  const std::optional<KeyframeId> similar = keyframe_with_similar_view(state_.mapper.online(), camera);
  if (!similar) return std::nullopt;
  const ScratchVector<PointId> points = local_points(state_.map(), *similar, options_.local_keyframes);
  const auto located_from = [&](const Pose& start) -> std::optional<Pose> {
    const auto tracked = track(frame, start, state_.rig, state_.map(), points, options_.track);
    if (!tracked || !is_finite(tracked->camera_from_world)) return std::nullopt;
    if (rejection_reason(*tracked, state_.rig, state_.map(), options_.relocalise) != LocalisationFailure::none) {
      return std::nullopt;
    }
    const Pose apart = tracked->camera_from_world * inverse(camera);
    const bool is_near = apart.translation.norm() <= kFarthest * median_depth(*tracked, state_.map()) &&
                         rotation_log(apart.rotation).norm() <= kFarthest;
    return is_near ? std::optional(body_pose(state_.rig, tracked->camera_from_world)) : std::nullopt;
  };
  if (const auto located = located_from(camera)) return located;
  const auto anywhere = pose_from_keyframe(frame, state_.rig, state_.map(), *similar);
  return anywhere ? located_from(*anywhere) : std::nullopt;
}

std::optional<Pose> Session::find_in_finished_map(const Frame& rectified) {
  const PlaceIndex* const places = state_.mapper.places();
  if (!places) return std::nullopt;
  const MapGraph& map = state_.mapper.online();
  const Frame frame = state_.mapper.corrected(rectified);
  const PlaceFilter exists{[&](KeyframeId id) { return map.find_keyframe(id) == nullptr; }, {}};
  const auto tracked = localise(frame, state_.rig, map, *places, options_.relocalise, exists).tracked;
  if (!tracked || !is_finite(tracked->camera_from_world)) return std::nullopt;
  const PlaceView view = view_of_map(frame, *tracked, median_depth(*tracked, map), state_.rig, map);
  if (log_odds_of(view) < RegistrationOptions{}.accept_log_odds) return std::nullopt;
  return body_pose(state_.rig, tracked->camera_from_world);
}

void Session::finish_mission(const FinishHooks& hooks) {
  if (state_.mapper.online().keyframe_count() == 0) return;
  const auto [lengths, offline] = state_.mapper.adjust_with_offline(hooks);
  state_.pose_filter.apply_length_changes(lengths);
  state_.pose_filter.refine_all_deferred(state_.map(), options_.track, offline);
}

std::vector<Timestamp> Session::frames_not_joined() const {
  return state_.pose_filter.trajectory().times_outside_map_frame(state_.mapper.submaps());
}

Trajectory Session::final_trajectory() const {
  return state_.pose_filter.trajectory().in_map_frame(state_.map(), state_.mapper.submaps(), state_.rig);
}

}  // namespace byre
