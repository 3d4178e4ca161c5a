#include "byre/slam/mapping/mapper.h"

#include "byre/map/scaled_copy.h"
#include "byre/slam/loops/recent_map.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/window/initialisation.h"

#include <algorithm>
#include <cassert>

namespace byre {
namespace {

constexpr std::uint32_t kNewKeyframes = 32;  // the size of a window, whose features stay in memory

}  // namespace

Mapper::Mapper(const Rig& rig, const MapperOptions& options, std::optional<Vocabulary> vocabulary,
               std::shared_ptr<const OfflineMap> offline)
    : options_(options), offline_(std::move(offline)) {
  if (vocabulary) places_.edit().emplace(*std::move(vocabulary));
  if (!rig.is_stereo() && !offline_) initialiser_.emplace(rig, options.monocular_start, options.mapping);
}

std::optional<KeyframeId> Mapper::newest_in_present_frame() const {
  return newest_ && submaps_.is_in_present_frame(*newest_) ? newest_ : std::nullopt;
}

void Mapper::continue_map(MapGraph online) {
  assert(places() && !offline_ && online.keyframe_count() > 0);
  online_ = std::move(online);
  initialiser_.reset();
  for (const KeyframeId id : online_.keyframe_ids()) places_.edit()->add(id, online_.find_keyframe(id)->words);
  newest_ = online_.keyframe_ids().back();
  first_new_ = next_keyframe_number();
  for (const KeyframeId id : online_.keyframe_ids()) {
    const StoredPicture& picture = online_.find_keyframe(id)->picture;
    if (picture) online_.set_picture(id, page_out(picture, *page_file_));
  }
  submaps_.begin_in_map_frame(0);
  page_out_all();
}

void Mapper::refine_calibration(const Calibration& given, const SelfCalibrationOptions& options) {
  calibrator_.emplace(given, options);
}

Mapper::Beginning Mapper::begin(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                                const AnchoredTrajectory& trajectory) {
  Beginning begun = rig.is_stereo() ? begin_stereo(frame, rig, camera_from_world, trajectory)
                                    : begin_monocular(frame, rig, camera_from_world, trajectory);
  if (begun.keyframes.empty()) return begun;
  newest_ = begun.keyframes.back();
  for (const KeyframeId id : begun.keyframes) encode_later(id);
  if (places()) {
    for (IndexedKeyframe& indexed : index_keyframes(online_, **places_, begun.keyframes, false, options_.loops)) {
      store(std::move(indexed));
    }
  }
  ++revision_;
  return begun;
}

// In a mission the place in the offline map is not yet determined.
Mapper::Beginning Mapper::begin_stereo(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                                       const AnchoredTrajectory& trajectory) {
  auto first = initialise_stereo(frame, rig, options_.min_initial_points);
  if (!first) return {};
  offline_ ? submaps_.begin_in_own_frame(next_keyframe_number()) : submaps_.begin_in_map_frame(next_keyframe_number());
  if (online_.keyframe_count() == 0 && !camera_from_world) {
    online_ = *std::move(first);
    return {{online_.keyframe_ids().front()}};
  }
  const Pose pose = camera_from_world.value_or(inverse(rig.body_from_camera));
  const KeyframeId id = add_keyframe_at(pose, frame, rig, parent_of_bridge(trajectory), online_, options_.recording);
  add_stereo_points(online_, id);
  return {{id}};
}

// The keyframe from which odometry leads to a new submap; empty in a mission, whose submaps have separate frames.
std::optional<KeyframeId> Mapper::parent_of_bridge(const AnchoredTrajectory& trajectory) const {
  return offline_ || trajectory.empty() ? std::nullopt : std::optional(trajectory.back().keyframe);
}

Mapper::Beginning Mapper::begin_monocular(const Frame& frame, const Rig& rig,
                                          const std::optional<Pose>& camera_from_world,
                                          const AnchoredTrajectory& trajectory) {
  std::optional<Pose> measured;  // camera from that of the reference frame
  if (camera_from_world && options_.monocular_start.is_scaled_by_odometry) {
    measured = *camera_from_world * inverse(odometry_reference_);
    if (!is_determined(*measured, options_.monocular_start.lever_arm_sigma)) measured.reset();
  }
  MonocularAttempt attempt = initialiser_->try_start(frame, camera_from_world.has_value(), measured);
  if (!attempt.start) {
    if (initialiser_->reference_time() == frame.time) {
      odometry_reference_ = camera_from_world.value_or(inverse(rig.body_from_camera));
    }
    return {{}, attempt.failure};
  }
  std::vector<KeyframeId> keyframes;
  if (online_.keyframe_count() > 0) {
    keyframes = camera_from_world ? add_submap_by_odometry(*attempt.start, *camera_from_world, trajectory)
                                  : add_submap_without_odometry(*attempt.start);
    if (keyframes.empty()) return {};
  } else {
    MonocularStart start = *std::move(attempt.start);
    if (camera_from_world) {
      const MonocularStartOptions& options = options_.monocular_start;
      const StartPoses measured{odometry_reference_, *camera_from_world};
      const auto scale = odometry_scale(start, measured, options.lever_arm_sigma);
      if (!scale && options.is_scaled_by_odometry) return {{}, TwoViewFailure::uncertain};
      start = align_to_odometry(start, measured, scale.value_or(1.0));
      contradicts_odometry_ = options.is_scaled_by_odometry && !agrees_with_odometry(start, measured);
      is_scaled_by_odometry_ = scale && !contradicts_odometry_;
    }
    keyframes = {start.first, start.second};
    online_ = std::move(start.map);
    submaps_.begin_in_map_frame(0);
  }
  initialiser_.reset();
  pending_.push_back(keyframes.back());
  return {keyframes, attempt.failure};
}

std::vector<KeyframeId> Mapper::add_submap_by_odometry(const MonocularStart& start, const Pose& camera_from_world,
                                                       const AnchoredTrajectory& trajectory) {
  const Timestamp first_time = start.map.find_keyframe(start.first)->frame.time;
  const auto first = trajectory.camera_at(first_time, map());
  if (!first) return {};
  const std::uint32_t first_number = next_keyframe_number();
  auto keyframes = add_monocular_submap(start, {*first, camera_from_world}, parent_of_bridge(trajectory),
                                        options_.recording, online_);
  if (!keyframes.empty()) submaps_.begin_in_map_frame(first_number);
  return keyframes;
}

// The parent lies in another frame. It makes the first keyframe movable, and removable if the submap is not joined.
std::vector<KeyframeId> Mapper::add_submap_without_odometry(const MonocularStart& start) {
  submaps_.begin_in_own_frame(next_keyframe_number());
  return add_separate_submap(start, newest_, options_.recording, online_);
}

void Mapper::allow_monocular_submap(const Rig& rig, bool is_allowed) {
  if (rig.is_stereo() || offline_ || online_.keyframe_count() == 0) return;
  if (!is_allowed) {
    initialiser_.reset();
  } else if (!initialiser_) {
    initialiser_.emplace(rig, options_.monocular_start, options_.mapping);
  }
}

void Mapper::begin_at_relocalisation(const HybridTrack& found) {
  if (found.online_reference) {
    submaps_.begin_in_frame_of(*found.online_reference, next_keyframe_number());
  } else {
    submaps_.begin_in_map_frame(next_keyframe_number());
  }
}

void Mapper::leave_map_frame(std::optional<Timestamp> after) {
  std::uint32_t first = 0;
  if (after) {
    first = next_keyframe_number();
    const std::vector<KeyframeId> ids = online_.keyframe_ids();
    for (auto id = ids.rbegin(); id != ids.rend() && online_.find_keyframe(*id)->frame.time > *after; ++id) {
      first = id->number;
    }
  }
  submaps_.leave_map_frame(first);
}

KeyframeId Mapper::add_keyframe(const Frame& frame, const HybridTrack& track, const Rig& rig) {
  Keyframe keyframe = make_keyframe(frame, track.tracked, online_.add_rig(rig));
  keyframe.recording = options_.recording;
  keyframe.parent = track.online_reference;
  const KeyframeId id = online_.add_keyframe(std::move(keyframe));
  add_stereo_points(online_, id, contradicting_features(track.tracked, *frame.features));
  newest_ = id;
  if (places()) unindexed_.push_back(id);
  ++revision_;
  pending_.push_back(id);
  encode_later(id);
  request_local_job();
  page_out_old_keyframe();
  return id;
}

// Moves features of old keyframes to the scratch file. Patches of features without a point are dropped: they serve only
// to triangulate new points among the newest keyframes. The other patches are needed as long as the map grows, to fuse
// points and to change their reference view; without them errors of maps with loops grow by some percent. Few are
// needed at a time, hence the file. Jobs write it, because the disk may be busy.
void Mapper::page_out_old_keyframe() {
  if (newest_->number < kNewKeyframes) return;
  const KeyframeId old{newest_->origin, newest_->number - kNewKeyframes};
  const Keyframe* const keyframe = online_.find_keyframe(old);
  if (keyframe == nullptr) return;
  std::vector<int> kept;
  for (int i = 0; i < static_cast<int>(keyframe->sightings.size()); ++i) {
    if (keyframe->sightings[static_cast<std::size_t>(i)].point) kept.push_back(i);
  }
  online_.keep_patches(old, kept);
  page_out_later(old);
}

void Mapper::page_out_later(KeyframeId id) {
  const Keyframe* const keyframe = online_.find_keyframe(id);
  if (keyframe != nullptr) to_page_out_.features.push_back({id, keyframe->frame.features});
}

void Mapper::encode_later(KeyframeId id) {
  const std::shared_ptr<const Image>& picture = online_.find_keyframe(id)->frame.picture;
  if (picture) to_page_out_.pictures.push_back({id, picture});
}

// A loaded map has all features in memory, and features that moved have new keypoints.
void Mapper::page_out_all() {
  to_page_out_.features.clear();
  for (const KeyframeId id : online_.keyframe_ids()) {
    if (id.number + kNewKeyframes <= newest_->number) page_out_later(id);
  }
}

// Searches older parts of the map for new keyframes. A match must be confirmed by the frames after it.
bool Mapper::search_loop(const LoopCloser::LoopFrame& now) {
  if (!places() || !may_request_map_job()) return false;
  const auto loop = loop_closer_.check(now, online_);
  if (loop) close_loop(*loop);
  return loop.has_value();
}

// In a mission large drift is corrected by the offline map, not by loops.
void Mapper::close_loop(const LoopHypothesis& loop) {
  const std::optional<LoopEdge> edge = edge_of(loop, online_);
  if (!edge) return;  // removed as redundant meanwhile
  const bool fusing_will_do = apparent_drift(loop, online_) <= options_.max_drift_to_fuse;
  if (!fusing_will_do && offline_) return;
  loop_closer_.add(*edge);
  if (fusing_will_do) {
    pending_.insert(pending_.begin(), {loop.place, loop.keyframe});
  } else {
    due_ = MapJob::correct;
  }
}

// Empty in a mission: the offline map fixes lengths, and motions would add nothing.
std::vector<KeyframeMotion> Mapper::motions_between(const std::vector<KeyframeId>& keyframes) const {
  if (offline_) return {};
  std::vector<KeyframeMotion> motions = odometry_motions(online_, keyframes, options_.recording, odometry_);
  for (KeyframeMotion& motion : motions) motion.holds_scale = is_scaled_by_odometry_;
  return motions;
}

std::vector<KeyframeMotion> Mapper::all_motions() const {
  std::vector<KeyframeMotion> motions = motions_between(online_.keyframe_ids());
  return is_scaled_by_odometry_ ? motions : in_lengths_of(online_, std::move(motions));
}

std::optional<double> Mapper::collect() {
  collect_index();
  auto finished = local_.collect();
  if (finished) {
    // A removed first keyframe of a separate submap would keep its pose relative to a keyframe of another frame.
    std::erase_if(finished->result.delta.removed_keyframes, [&](KeyframeId id) {
      const Keyframe* const keyframe = online_.find_keyframe(id);
      return keyframe != nullptr && keyframe->parent && submaps_.frame(id) != submaps_.frame(*keyframe->parent);
    });
    apply_update(finished->result);
  }
  if (auto optimised = whole_.collect()) outcome_ = std::move(optimised->result);
  return finished ? std::optional(finished->seconds) : std::nullopt;
}

void Mapper::apply_update(const LocalOutcome& outcome) {
  apply(outcome.delta, online_);
  ++revision_;
  forget_places(outcome.delta);
  for (const KeyframePicture& of : outcome.paged.pictures) online_.set_picture(of.keyframe, of.encoded);
  for (const KeyframeFeatures& of : outcome.paged.features) {
    const Keyframe* const keyframe = online_.find_keyframe(of.keyframe);
    if (keyframe != nullptr && keyframe->frame.features == of.features) online_.replace_features(of.keyframe, of.paged);
  }
}

// A new readout time changes keyframe poses. In a mission the offline map corrects them, else a global adjustment does.
bool Mapper::apply_readout_change(RollingShutterCorrector& corrector, const Rig& rig) {
  if (!corrector.has_change() || !local_.is_idle() || !may_request_map_job()) return false;
  corrector.apply_update(rig, online_);
  page_out_all();
  ++revision_;
  loop_closer_.forget_hypothesis();
  if (!offline_ && online_.keyframe_count() > 1) due_ = MapJob::correct;
  return true;
}

// Waits for the local job, whose data are by the previous calibration.
std::optional<RigRotation> Mapper::apply_calibration(const Rig& rig) {
  if (!calibrator_ || !local_.is_idle()) return std::nullopt;
  if (auto by = take_calibration()) {
    const RigRotation turn = recalibrate(std::move(by->recalibration), rig);
    page_out_all();
    if (by->correction) outcome_ = std::move(*by->correction);
    return turn;
  }
  if (!may_request_map_job() || !calibrator_->is_due(online_.keyframe_count())) return std::nullopt;
  calibrator_->note_attempt(online_.keyframe_count());
  rig_to_calibrate_ = online_.add_rig(rig);
  due_ = MapJob::calibrate;
  return std::nullopt;
}

// The rectified camera rotates, because the rectification depends on the calibration.
RigRotation Mapper::recalibrate(Recalibration by, const Rig& rig) {
  const int index = online_.add_rig(rig);
  online_.recalibrate(index, by.from_present, by.features);
  calibrator_->apply_update(by.refined, std::move(by.from_given));
  RigRotation turn{by.from_present.after_from_before(), index, by.from_present.rig()};
  loop_closer_.rotate_rig(turn, online_);
  ++revision_;
  return turn;
}

MapCalibration Mapper::take_calibration() {
  if (!outcome_ || is_correction_waiting()) return std::nullopt;
  return std::get<MapCalibration>(*std::exchange(outcome_, std::nullopt));
}

std::optional<LengthChanges> Mapper::apply_map_optimisation() {
  if (!is_correction_waiting() || !local_.is_idle()) return std::nullopt;
  const MapCorrection correction = std::get<MapCorrection>(*std::exchange(outcome_, std::nullopt));
  LengthChanges changes = apply_correction(correction.delta, *correction.outline, online_);
  forget_places(correction.delta);
  loop_closer_.apply_length_changes(changes);
  ++revision_;
  return changes;
}

void Mapper::correct_later(const OnlineCorrection& correction) {
  assert(!waiting_correction_);
  waiting_correction_ = correction;
}

std::optional<Pose> Mapper::correct_online() {
  if (!waiting_correction_ || !local_.is_idle()) return std::nullopt;
  const OnlineCorrection correction = *std::exchange(waiting_correction_, std::nullopt);
  std::vector<KeyframeId> path = online_.keyframe_ids();
  std::erase_if(path, [&](KeyframeId id) {
    return id.number < correction.first_keyframe || submaps_.frame(id) != correction.frame;
  });
  apply(correction_of(online_, path, correction.offline_from_online, correction.shape), online_);
  submaps_.join_map_frame(correction.frame);
  ++revision_;
  if (newest_ && pending_.empty()) pending_.push_back(*newest_);
  return correction.offline_from_online;
}

// Not before a waiting correction, which moves the job's keyframes.
void Mapper::request_local_job() {
  if (pending_.empty() || !local_.is_idle() || is_correction_waiting() || waiting_correction_) return;
  MapWindow window = cut_window(map(), pending_, options_.mapping.window);
  pending_.clear();
  if (window.keyframes.empty()) return;
  std::vector<KeyframeId> online;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (!is_offline(keyframe)) online.push_back(keyframe.id);
  }
  add_motions(window, motions_between(online));
  MappingOptions mapping = options_.mapping;
  // Nothing corrects the drift of a mission beyond its map, while finishing a map corrects that of mapping.
  constexpr double kSharedError = 0.1;  // pixels, measured on drives through an unmapped store
  if (offline_) mapping.systematic_sigma = kSharedError;
  mapping.hidden = hidden_;
  local_.request([window = std::move(window), options = mapping, to_page_out = std::exchange(to_page_out_, {}),
                  file = page_file_] { return extend_map_locally(window, options, to_page_out, *file); });
}

void Mapper::request_jobs() {
  request_index();
  request_map_job();
}

void Mapper::request_index() {
  const bool searches_loop = loop_closer_.take_search_request();
  if (!index_.is_idle()) return;
  std::erase_if(unindexed_, [&](KeyframeId id) { return online_.find_keyframe(id) == nullptr; });
  if (unindexed_.empty()) return;
  index_.request(
      [map = online_, places = places_, keyframes = std::exchange(unindexed_, {}), searches_loop,
       options = options_.loops] { return index_keyframes(map, **places, keyframes, searches_loop, options); });
}

void Mapper::request_map_job() {
  const auto stop = [early = is_finishing_early_, file = page_file_] {
    return releasing_pages(*file, [early] { return early->load(); });
  };
  if (due_ == MapJob::correct) {
    whole_.request([map = std::make_shared<MapGraph>(joined_online()), first_new = first_new_, loops = loops(),
                    motions = all_motions(), options = GlobalMappingOptions{options_.mapping}, stop] {
      LoopClosureInput input = copy_for_loop_closure(*map, first_new, loops, motions);
      *map = MapGraph(Origin::online);  // the snapshot is not needed any more
      return MapOutcome(close_loops(std::move(input), options, stop()));
    });
  } else if (due_ == MapJob::calibrate) {
    CalibrationInput input{joined_online(), calibrator_->state(), rig_to_calibrate_, loops(), all_motions()};
    whole_.request([input = std::make_shared<CalibrationInput>(std::move(input)), options = calibrator_->options(),
                    global = GlobalMappingOptions{options_.mapping}, file = page_file_, stop] {
      MapCalibration calibration = calibrate(std::move(*input), options, global, stop());
      file->release_pages();
      return MapOutcome(std::move(calibration));
    });
  }
  due_ = MapJob::none;
}

void Mapper::collect_index() {
  auto finished = index_.collect();
  if (!finished) return;
  for (IndexedKeyframe& indexed : finished->result) store(std::move(indexed));
}

// Mapping may have removed the keyframe meanwhile.
void Mapper::store(IndexedKeyframe indexed) {
  if (online_.find_keyframe(indexed.keyframe) == nullptr) return;
  places_.edit()->add(indexed.keyframe, indexed.words);
  online_.set_words(indexed.keyframe, std::move(indexed.words));
  if (indexed.loop) loop_closer_.set_hypothesis(*indexed.loop);
}

void Mapper::forget_places(const MapDelta& delta) {
  if (!places()) return;
  for (const OnlineKeyframeId id : delta.removed_keyframes) places_.edit()->remove(id);
}

LengthChanges Mapper::finish(const std::function<void()>& run_jobs) {
  run_jobs();
  collect_index();
  request_jobs();
  LengthChanges lengths;  // by the one correction that may be in flight
  while (true) {
    run_jobs();
    collect();
    if (auto changes = apply_map_optimisation()) lengths = *std::move(changes);
    correct_online();
    if (pending_.empty()) return lengths;
    request_local_job();
  }
}

MapGraph Mapper::joined_online() const {
  MapGraph joined = online_;
  if (offline_ || !submaps_.has_separate()) return joined;
  for (const KeyframeId id : online_.keyframe_ids()) {
    if (!is_in_map(id)) joined.remove_keyframe(id);
  }
  return joined;
}

LengthChanges Mapper::join_submaps() {
  LengthChanges changes;
  if (offline_ || !submaps_.has_separate()) return changes;
  bool has_joined = !*is_finishing_early_;
  while (std::exchange(has_joined, false)) {
    for (std::size_t i = 0; i < submaps_.size(); ++i) {
      const Submaps::Frame frame = submaps_.frame(i);
      has_joined = (frame != Submaps::kMapFrame && join_submap(frame, changes)) || has_joined;
    }
  }
  for (const KeyframeId id : online_.keyframe_ids()) {
    if (!is_in_map(id)) places_.edit()->remove(id);
  }
  online_ = joined_online();
  newest_ = online_.keyframe_ids().back();
  ++revision_;
  return changes;
}

// Moves the submap by the join with the most precise scale.
bool Mapper::join_submap(Submaps::Frame frame, LengthChanges& changes) {
  std::vector<KeyframeId> keyframes = online_.keyframe_ids();
  std::erase_if(keyframes, [&](KeyframeId id) { return submaps_.frame(id) != frame; });
  const std::vector<LoopHypothesis> joins = search_joins(
      online_, **places_, keyframes, [&](KeyframeId id) { return is_in_map(id); }, options_.loops);
  if (joins.empty()) return false;
  const LoopHypothesis& best = *std::ranges::min_element(joins, {}, &LoopHypothesis::scale_sigma);
  LengthChanges moved;
  for (KeyframeId id{Origin::online, 0}; online_.living_ancestor(id); ++id.number) {
    if (submaps_.frame(id) == frame) moved[id] = best.scale;
  }
  for (const LoopHypothesis& join : joins) joins_.push_back(in_new_lengths(*edge_of(join, online_), moved));
  move_part(online_, drift_of(best), [&](KeyframeId id) { return moved.contains(id); });
  loop_closer_.apply_length_changes(moved);
  submaps_.join_map_frame(frame);
  changes.merge(moved);
  return true;
}

std::optional<RigRotation> Mapper::calibrate_finally(const Rig& rig, const std::function<bool()>& should_stop) {
  if (!calibrator_ || !calibrator_->is_final_run_useful(online_.keyframe_count())) return std::nullopt;
  calibrator_->note_attempt(online_.keyframe_count());
  // The copy of the map is freed before the features are converted, because it would store the old ones.
  const auto refined = self_calibrate(whole_map(map()), calibrator_->state(), online_.add_rig(rig),
                                      calibrator_->options(), releasing_pages(*page_file_, should_stop));
  if (!refined) return std::nullopt;
  return recalibrate(recalibration_by(*refined, calibrator_->state()), rig);
}

FinishReport Mapper::finish_map(const FinishHooks& hooks) {
  assert(places());
  const auto disagrees = [&](const LoopEdge& loop) { return disagreement(online_, loop) > kMaxLoopDisagreement; };
  const std::uint32_t first_new = std::ranges::any_of(loops(), disagrees) ? 0 : first_new_;
  to_page_out_ = {};  // no more jobs
  if (first_new == 0) page_out_features(online_, *page_file_);
  const FinishHooks frugal{releasing_pages(*page_file_, hooks.should_stop), hooks.before_step};
  FinishReport report = byre::finish_map(
      online_, **places_, {options_.loops, {options_.mapping}, all_motions(), first_new, joins_}, frugal);
  loop_closer_.apply_length_changes(report.length_changes);
  return report;
}

std::pair<LengthChanges, AdjustedOffline> Mapper::adjust_with_offline(const FinishHooks& hooks) {
  assert(offline_);
  constexpr int kFirstIterations = 3;  // each map is adjusted already
  MapWindow both = both_maps(map());
  MapWindow before = outline_of(both);
  adjust_window(both, {}, {options_.mapping, kFirstIterations}, releasing_pages(*page_file_, hooks.should_stop));
  AdjustedOffline offline = detach_offline(both, before);
  LengthChanges changes = apply_correction(difference(before, both), before, online_);
  loop_closer_.apply_length_changes(changes);
  return {std::move(changes), std::move(offline)};
}

LengthChanges Mapper::rescale(double factor) {
  assert(!offline_);
  byre::rescale(online_, factor);
  LengthChanges changes;
  for (KeyframeId id{Origin::online, 0}; online_.living_ancestor(id); ++id.number) changes[id] = factor;
  loop_closer_.apply_length_changes(changes);
  return changes;
}

}  // namespace byre
