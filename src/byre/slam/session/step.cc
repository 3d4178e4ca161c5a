#include "byre/slam/session/step.h"

#include "byre/base/stopwatch.h"
#include "byre/geometry/finite.h"
#include "byre/slam/session/frame_summary.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace byre {
namespace {

// Result of tracking or localising a frame.
struct Located {
  std::optional<HybridTrack> track;
  std::vector<HybridTrack> elsewhere;  // other places that show the frame
  bool is_relocalised = false;
  bool is_jump = false;         // see PoseFilter::is_jump
  bool is_by_hint = false;      // the search was limited to a hint
  bool returns_to_map = false;  // relocalised in the map frame, after a separate submap
  bool begins_submap = false;   // the frame became the first keyframe of a submap
  TwoViewFailure start_failure = TwoViewFailure::none;
  DistrustReason refused = DistrustReason::none;  // why a place that shows the frame was rejected
};

bool is_mapping(const RobotState& state, const SessionOptions& options) {
  return !state.is_mapping_paused && (options.map_online || !state.mission);
}

void lose_pose(RobotState& state, ImageFault fault, FrameReport& report) {
  if (state.pose_filter.has_pose() && state.status == State::tracking) {
    report.events.push_back(SessionEvent::pose_lost);
    if (fault != ImageFault::none) report.events.push_back(SessionEvent::blinded);
  }
  state.pose_filter.mark_lost();
  if (state.mission) state.mission->mark_lost();
}

// A correction of the online map's own calibration rotates its keyframes as well. In a mission frames have a new rig
// from here on, and keyframes keep theirs.
bool apply_camera_change(RobotState& state) {
  if (const auto rotation = state.mapper.apply_calibration(state.rig)) {
    state.rig = rotation->after;
    state.pose_filter.rotate_rig(*rotation, state.mapper.online());
    return true;
  }
  const auto change = state.mission ? state.mission->collect_camera() : std::nullopt;
  if (!change) return false;
  state.rig = change->rig;
  state.pose_filter.rotate_camera(change->after_from_before);
  state.mapper.forget_loop();
  return true;
}

void apply_place_search(RobotState& state, FrameReport& report) {
  OfflineTracker& mission = *state.mission;
  const std::optional<PlaceSearch> search = mission.collect_place();
  if (search) report.refused_place = search->refused;
  if (search && search->focal) mission.note_focal_length(*search->focal);
  const OfflineTracker::MissionUpdate update = mission.process_search(search, state.pose_filter, state.mapper);
  if (update.correction) state.mapper.correct_later(*update.correction);
  if (update.agrees_with_hint) state.pose_filter.note_agreement();
  if (update.refutes_pose) {
    if (state.pose_filter.is_by_hint()) state.hint.clear();
    // Poses at an accepted place stay in the map.
    const auto accepted = update.refutes_earlier_poses ? std::nullopt : state.pose_filter.last_accepted();
    state.mapper.leave_map_frame(accepted);
    if (accepted) state.pose_filter.move_to_submap(state.mapper.submaps().present(), *accepted);
    lose_pose(state, ImageFault::none, report);
  }
  if (update.refutes_earlier_poses) {
    state.pose_filter.reset();
    state.trusted_place.forget();
    report.events.push_back(SessionEvent::place_refuted);
  }
}

void apply_finished_jobs(RobotState& state, FrameReport& report) {
  constexpr double kLeastCorrection = 1e-6;  // metres and radians; smaller values are rounding
  const bool was_registered = state.is_registered();
  report.job_seconds = state.mapper.collect();
  const bool is_shutter_better = state.mapper.apply_readout_change(state.rolling_shutter, state.rig);
  if (apply_camera_change(state) || is_shutter_better) report.events.push_back(SessionEvent::recalibrated);
  if (const auto changes = state.mapper.apply_map_optimisation()) {
    state.pose_filter.apply_length_changes(*changes);
    state.pose_filter.forget_carried();
    report.events.push_back(SessionEvent::map_corrected);
  }
  if (state.mission) apply_place_search(state, report);
  if (const auto offline_from_online = state.mapper.correct_online()) {
    state.pose_filter.note_online_correction();
    if (!was_registered && state.is_registered()) {
      state.pose_filter.note_registration(*offline_from_online, state.hint.get().has_value());
    }
    report.events.push_back(SessionEvent::online_corrected);
  }
  const auto correction = state.pose_filter.apply_map_correction(state.rig, state.map());
  if (!correction || !was_registered || !state.is_registered()) return;
  if (log_pose(*correction).norm() > kLeastCorrection) report.correction = correction;
}

// The frame by the present calibration, with evidence against its images.
InputFrame check_input(RobotState& state, const StepInput& input, const SessionOptions& options) {
  Frame frame = state.mapper.corrected(input.frame);
  if (state.mission) frame = state.mission->corrected(frame);
  const CameraMotion motion = state.pose_filter.camera_motion();
  const InputEvidence evidence = state.image_monitor.check(frame, state.rig, {input.motion, motion});
  frame = state.rolling_shutter.corrected(frame, state.rig, motion);
  const ImageFault fault = frame.condition ? fault_of(*frame.condition, options.image) : ImageFault::none;
  state.mapper.note_images(evidence.cameras_disagree);
  return {std::move(frame), fault, evidence};
}

Tracker::Scene scene_of(RobotState& state, const InputFrame& input) {
  OfflineTracker* const mission = state.mission ? &*state.mission : nullptr;
  return {state.rig,
          state.mapper,
          mission ? &mission->mission() : nullptr,
          mission && mission->is_focal_check_due(),
          state.hint.get(),
          state.pose_filter.place().is_accepted(),
          state.trusted_place.reach_from_there(),
          mission ? state.pose_filter.drift_sigma(mission->length_sigma()) : HybridLimits::kNoLimit,
          mission ? mission->ground_under(state.pose_filter, state.mapper) : nullptr,
          input.cuts.online_points,
          state.dirt_detector.hidden()};
}

void drop_non_finite(std::optional<HybridTrack>& track) {
  if (track && !is_finite(track->tracked.camera_from_world)) track.reset();
}

// Measured motion contradicts the pose, and the offline points in view do not outweigh it. The motion is then followed.
bool contradicts_motion(RobotState& state, const Frame& frame, const HybridTrack& track) {
  if (!state.pose_filter.is_unreachable(frame, track, state.rig, state.map())) return false;
  if (!state.mission || track.offline_inliers == 0) return true;
  const double log_odds = state.mission->log_odds_of(frame, track, state.rig, state.dirt_detector.hidden());
  return log_odds + kLogOddsOfKidnapping < 0.0;
}

std::optional<HybridTrack> track_from_last_pose(RobotState& state, const Frame& frame, const Tracker::Scene& scene) {
  auto track = state.tracker.track(frame, scene, state.pose_filter.trajectory().back(), state.pose_filter.motion());
  drop_non_finite(track);
  if (!track) return track;
  if (track->focal) state.mission->note_focal_length(*track->focal);
  const bool is_sure = state.pose_filter.place().is_confirmed();
  if (contradicts_motion(state, frame, *track) || (!is_sure && state.tracker.is_doubtful(*track, scene))) track.reset();
  return track;
}

// Puts the place with the highest log-odds first, by this frame and, at a place that continues a test, by those before.
void sort_by_log_odds(RobotState& state, std::vector<HybridTrack>& places, const Frame& frame) {
  if (places.size() < 2) return;
  std::vector<double> log_odds;
  for (const HybridTrack& found : places) {
    const Pose& camera = found.tracked.camera_from_world;
    PlaceHypothesis place = state.pose_filter.hypothesis_of_relocalisation(
        frame.time, body_pose(state.rig, camera), state.mission->find_place_test(frame.time, camera), state.rig,
        state.map());
    place.observe(state.mission->view_of(frame, found, state.rig, state.dirt_detector.hidden(), false), true);
    log_odds.push_back(place.log_odds());
  }
  std::swap(places.front(), places[static_cast<std::size_t>(std::ranges::max_element(log_odds) - log_odds.begin())]);
}

// Localises without a prediction. is_in_map: only in the map frame.
Located find_place(RobotState& state, const Frame& frame, const Tracker::Scene& scene, bool is_in_map) {
  Tracker::Find find;
  if (auto found =
          state.mission ? state.mission->find_at_rival(frame, state.rig, state.dirt_detector.hidden()) : std::nullopt) {
    find.places.push_back(found_in(Origin::offline, *std::move(found)));
  }
  if (find.places.empty()) find = state.tracker.find(frame, scene, is_in_map);
  sort_by_log_odds(state, find.places, frame);
  Located located;
  located.refused = find.refused;
  if (find.focal && state.mission) state.mission->note_focal_length(*find.focal);
  if (!find.places.empty()) {
    located.track = std::move(find.places.front());
    located.elsewhere.assign(std::make_move_iterator(find.places.begin() + 1),
                             std::make_move_iterator(find.places.end()));
  }
  drop_non_finite(located.track);
  if (located.track && !state.hint.get() && contradicts_motion(state, frame, *located.track)) located.track.reset();
  located.is_relocalised = located.track.has_value();
  located.is_by_hint = located.is_relocalised && state.hint.get();
  if (located.track) state.mapper.begin_at_relocalisation(*located.track);
  return located;
}

bool may_begin_submap(const RobotState& state, const InputFrame& input, const SessionOptions& options) {
  const PoseFilter& pose_filter = state.pose_filter;
  if (!is_mapping(state, options) || !state.mapper.can_begin(state.rig)) return false;
  const AnchoredTrajectory& trajectory = pose_filter.trajectory();
  if (trajectory.empty()) {
    return state.mapper.online().keyframe_count() == 0 || (state.mission && state.rig.is_stereo());
  }
  if (input.fault != ImageFault::none) return false;
  if (!state.mission && state.rig.is_stereo() && !pose_filter.bridge()) return false;
  const Timestamp last_seen = pose_filter.last_seen().value_or(trajectory.back().time);
  return to_seconds(input.frame.time - last_seen) >= options.mission.restart_after;
}

Located begin_submap(RobotState& state, const Frame& frame) {
  PoseFilter& pose_filter = state.pose_filter;
  const AnchoredTrajectory& trajectory = pose_filter.trajectory();
  std::optional<Pose> predicted;  // camera_from_world
  if (!trajectory.empty() && (state.mission || pose_filter.bridge())) {
    predicted = pose_filter.motion().predict(camera_from_world(state.map(), trajectory.back()), state.rig, 0.0);
  } else if (const auto measured = pose_filter.start_by_odometry()) {
    predicted = camera_pose(state.rig, *measured);
  }
  const Mapper::Beginning begun = state.mapper.begin(frame, state.rig, predicted, trajectory);
  if (begun.keyframes.empty()) return {.track = {}, .elsewhere = {}, .start_failure = begun.failure};
  pose_filter.begin(begun.keyframes, state.mapper.submaps().present(), state.rig, state.mapper.online());
  state.tracker.restart_from(begun.keyframes.back());
  state.keyframe_policy.restart(begun.keyframes.back());
  if (state.mission) state.mission->begin_submap();
  return {.track = {}, .elsewhere = {}, .begins_submap = true, .start_failure = begun.failure};
}

// Whether the present submap has a frame of its own in a map that is being made.
bool is_separate(const RobotState& state) {
  return !state.mission && !state.mapper.submaps().empty() && !state.is_registered();
}

// Tracks the frame from the last pose, otherwise localises it in the maps, otherwise begins a submap with it. Frames of
// a separate submap are localised in the map first.
Located locate(RobotState& state, const InputFrame& input, const SessionOptions& options) {
  const Frame& frame = input.frame;
  const PoseFilter& pose_filter = state.pose_filter;
  const Tracker::Scene scene = scene_of(state, input);
  const bool can_search = state.mission || state.mapper.places();
  const bool is_refuted = state.mission && state.mission->is_place_refuted();
  const bool returns_by_odometry = can_search && !is_refuted && pose_filter.can_return_by_odometry();
  Located located;
  if (is_separate(state) && pose_filter.has_pose()) {
    located = find_place(state, frame, scene, true);
    located.returns_to_map = located.is_relocalised;
    if (located.track) return located;
  }
  if (!pose_filter.trajectory().empty() && (pose_filter.has_pose() || !can_search || returns_by_odometry)) {
    located.track = track_from_last_pose(state, frame, scene);
  }
  located.is_jump = state.mission && located.track && !returns_by_odometry &&
                    pose_filter.is_jump(frame, *located.track, state.rig, state.map());
  located.is_relocalised = located.track && (returns_by_odometry || located.is_jump);
  if (!located.track && can_search) located = find_place(state, frame, scene, false);
  state.mapper.allow_monocular_submap(
      state.rig, !located.track && (pose_filter.bridge() || state.mapper.may_begin_separate_submap()));
  if (!located.track && may_begin_submap(state, input, options)) return begin_submap(state, frame);
  return located;
}

void update_pose(RobotState& state, const InputFrame& input, const Located& located, FrameReport& report) {
  const HybridTrack& track = *located.track;
  PoseFilter& pose_filter = state.pose_filter;
  const ImageMask& hidden = state.dirt_detector.hidden();
  if (located.is_relocalised && !state.mission && pose_filter.motion().measured()) {
    state.keyframe_policy.require_keyframe();
  }
  const bool is_on_map = state.mission && state.is_registered();
  std::optional<PlaceHypothesis> known_place;
  std::optional<PlaceView> view;
  if (is_on_map) {
    if (located.is_relocalised) {
      known_place = state.mission->begin_place(input.frame.time, track.tracked.camera_from_world);
    }
    state.mission->test_rivals({input.frame, track, state.rig, 0.0, false, {}, hidden}, located.elsewhere, pose_filter,
                               state.mapper);
    if (located.is_relocalised || state.mission->is_view_due(input.frame, pose_filter)) {
      view = state.mission->view_of(input.frame, track, state.rig, hidden,
                                    located.is_relocalised || !pose_filter.place().is_accepted());
    }
  }
  const PoseFilter::Progress progress = pose_filter.note(
      {input.frame, track, located.is_relocalised, state.is_registered(), state.mapper.submaps().present(),
       located.is_by_hint, view ? &*view : nullptr, known_place ? &*known_place : nullptr,
       is_on_map ? state.mission->log_odds_of_rivals() : kNoRivals,
       is_on_map ? pose_filter.drift_sigma(state.mission->length_sigma()) : 0.0, located.is_jump},
      state.rig, state.map());
  state.tracker.note(track);
  if (!input.cuts.online_points) {
    state.keyframe_policy.note_track(anchor_of(track), static_cast<int>(track.tracked.features.size()));
  }
  if (progress.was_accepted && !located.is_relocalised) {
    state.rolling_shutter.note(input.frame, state.rig, track.tracked, state.map(), pose_filter.motion().velocity());
  }
  if (is_on_map) {
    const OfflineTracker::MissionUpdate update =
        state.mission->note({input.frame, track, state.rig, progress.step, input.fault != ImageFault::none,
                             state.tracker.offline_points(), hidden, view ? &*view : nullptr},
                            pose_filter, state.mapper);
    if (state.mission->is_drift_closed())
      pose_filter.note_held(sigma_between_maps(track), state.mission->length_sigma());
    report.events.insert(report.events.end(), update.events.begin(), update.events.end());
    report.moved_tags = update.moved_tags;
    if (update.correction) state.mapper.correct_later(*update.correction);
  }
  if (!pose_filter.place().is_confirmed() || !state.is_registered()) return;
  if (state.mission && !progress.was_ever_confirmed) {
    report.events.push_back(SessionEvent::localised);
  } else if (needs_relocalisation(state.status) || located.returns_to_map) {
    report.events.push_back(SessionEvent::relocalised);
  }
}

// Only for tracked, confirmed poses on a faultless image.
void update_dirt_mask(RobotState& state, const InputFrame& input, const Located& located, FrameReport& report) {
  const bool is_known = state.pose_filter.place().is_confirmed();
  if (located.is_relocalised || !is_known || input.fault != ImageFault::none || located.track->maps_disagree) return;
  state.dirt_detector.note(input.frame, located.track->tracked, state.rig, state.map());
  state.mapper.note_hidden(state.dirt_detector.hidden());
  if (const auto event = state.dirt_detector.take_event()) report.events.push_back(*event);
}

bool should_add_keyframe(RobotState& state, const InputFrame& input, const HybridTrack& track,
                         const SessionOptions& options) {
  if (!is_mapping(state, options)) return false;
  if (!state.pose_filter.place().is_confirmed() || input.fault != ImageFault::none) return false;
  const KeyframeEvidence evidence = state.keyframe_policy.evidence(track, state.map(), state.mapper.pending());
  return state.keyframe_policy.should_add_keyframe(track, evidence, input.cuts, options.keyframes);
}

// Offline points that constrain the pose leave no drift for a loop to correct.
bool search_loop(RobotState& state, const Frame& frame, bool keyframe_added) {
  const auto newest = state.mapper.newest_keyframe();
  const bool is_held = state.mission && state.is_registered() && state.mission->mission().view() == OfflineView::held;
  if (!newest || is_held) return false;
  const Pose camera_from_map = camera_from_world(state.map(), state.pose_filter.trajectory().back());
  return state.mapper.search_loop({frame, camera_from_map, state.rig, *newest, keyframe_added});
}

// Adds a keyframe if needed; searches loops and places with every tracked frame.
void extend_map(RobotState& state, const InputFrame& input, const HybridTrack& track, const SessionOptions& options,
                FrameReport& report) {
  if (should_add_keyframe(state, input, track, options)) {
    const KeyframeId id = state.mapper.add_keyframe(input.frame, track, state.rig);
    state.rolling_shutter.note_keyframe(id);
    state.tracker.restart_from(id);
    state.keyframe_policy.restart(id);
    state.pose_filter.anchor_to(id);
    report.keyframe_added = true;
  }
  if (search_loop(state, input.frame, report.keyframe_added)) report.events.push_back(SessionEvent::loop_found);
  if (!state.mission) return;
  state.mission->search_in_background(
      {input.frame, state.rig, state.hint.get(), state.trusted_place.reach_from_there(), state.dirt_detector.hidden()},
      state.pose_filter, state.mapper);
}

// Propagates the pose of a frame that was not located by measured motion.
void continue_without_track(RobotState& state, const InputFrame& input, FrameReport& report) {
  lose_pose(state, input.fault, report);
  state.pose_filter.propagate(input.frame.time, state.rig, state.map(),
                              state.mission ? state.mission->ground_under(state.pose_filter, state.mapper) : nullptr);
}

// The quality of a confirmed pose is the start of poses predicted from it.
void note_quality(RobotState& state, const FrameReport& report) {
  PoseFilter& pose_filter = state.pose_filter;
  if (!pose_filter.has_pose() || !report.map_from_body || !pose_filter.place().is_confirmed()) return;
  pose_filter.note_quality({report.covariance, report.odometry_covariance, report.health.verdict});
  if (state.mission && report.health.verdict == Verdict::trusted) {
    state.trusted_place.note({report.time, *report.map_from_body});
  }
}

// Adds the poses with their covariances, the state, the health and the verdict to the report.
void assess_pose(RobotState& state, const InputFrame& input, const Located& located, const SessionOptions& options,
                 FrameReport& report) {
  const PoseFilter& pose_filter = state.pose_filter;
  const Timestamp now = input.frame.time;
  const double seconds_without = to_seconds(now - pose_filter.last_confirmed().value_or(*state.first_frame));
  const FrameSummary summary{input,
                             located.track ? &*located.track : nullptr,
                             state.rig,
                             pose_filter,
                             state.mapper,
                             state.mission ? &*state.mission : nullptr,
                             state.dirt_detector,
                             *state.first_frame,
                             report.refused_place};
  state.status = next_state(state.status, {pose_filter.has_pose(), pose_filter.place().is_confirmed(), seconds_without},
                            options.state);
  report = fill_poses(std::move(report), summary);
  report.state = state.status;
  const HealthEvidence evidence = state.fault_latches.latch(now, evidence_of(summary));
  report.health = health_of(summary, report.covariance, evidence, options.health);
  withhold_non_finite(report);
  note_quality(state, report);
  if (state.trusted_place.is_new_refusal(report.refused_place, report.health.verdict)) {
    report.events.push_back(SessionEvent::place_refused);
  }
  const bool is_error = state.mission ? seconds_without >= options.state.lost_after : state.status == State::lost;
  if (!std::exchange(state.is_error_reported, is_error) && is_error) {
    report.events.push_back(SessionEvent::navigation_error);
  }
}

}  // namespace

Step step(RobotState& state, const StepInput& given, const SessionOptions& options) {
  FrameReport report;
  report.time = given.frame.time;
  if (!state.first_frame) state.first_frame = report.time;
  const Stopwatch mapping_before;
  state.pose_filter.set_tilt(given.tilt);
  state.pose_filter.add_odometry(given.motion);
  state.hint.expire(report.time);
  apply_finished_jobs(state, report);
  InputFrame input = check_input(state, given, options);
  state.mapper.request_local_job();
  report.map_seconds = mapping_before.seconds();

  if (given.budget != nullptr) input.cuts = given.budget->begin_tracking();
  const Stopwatch tracking;
  const Located located = locate(state, input, options);
  report.track_seconds = tracking.seconds();
  const TrackedFrame* const tracked = located.track ? &located.track->tracked : nullptr;
  input.evidence.out_of_sync = state.image_monitor.out_of_sync(input.frame, state.rig, tracked, state.map());
  if (given.budget != nullptr && tracked) given.budget->note_tracked();

  const Stopwatch mapping_after;
  state.keyframe_policy.note_frame(input.frame, state.rig);
  report.start_failure = located.start_failure;
  if (located.refused != DistrustReason::none) report.refused_place = located.refused;
  report.keyframe_added = located.begins_submap;
  if (located.track) {
    update_pose(state, input, located, report);
    update_dirt_mask(state, input, located, report);
    extend_map(state, input, *located.track, options, report);
  } else if (located.begins_submap) {
    const bool is_first = state.mapper.submaps().size() == 1;
    report.events.push_back(is_first ? SessionEvent::initialised : SessionEvent::restarted);
  } else {
    continue_without_track(state, input, report);
  }
  if (given.budget != nullptr && (!tracked || state.keyframe_policy.is_short())) given.budget->keep_next_whole();

  assess_pose(state, input, located, options, report);
  state.pose_filter.refine_overdue(state.map(), options.track);
  state.seen.clear();
  if (tracked) append_seen_points(*tracked, state.seen);
  state.mapper.request_jobs();
  report.map_seconds += mapping_after.seconds();
  return {std::move(report), take_requests(state)};
}

std::vector<JobRequest> take_requests(RobotState& state) {
  std::vector<JobRequest> requests;
  for (const JobKind kind : kJobKinds) {
    JobState* const job = state.job(kind);
    if (auto request = job ? job->take_request() : std::nullopt) requests.push_back({kind, *std::move(request)});
  }
  return requests;
}

void deliver(JobKind kind, FinishedJob finished, RobotState& state) {
  if (JobState* const job = state.job(kind)) job->deliver(std::move(finished));
}

}  // namespace byre
