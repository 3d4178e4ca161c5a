#pragma once

#include "byre/base/job_slot.h"
#include "byre/slam/frame/hybrid_tracking.h"
#include "byre/slam/loops/odometry_motions.h"
#include "byre/slam/mapping/anchored_trajectory.h"
#include "byre/slam/mapping/calibrator.h"
#include "byre/slam/mapping/loop_closer.h"
#include "byre/slam/mapping/map_jobs.h"
#include "byre/slam/mapping/mapper_options.h"
#include "byre/slam/mapping/rolling_shutter_corrector.h"
#include "byre/slam/mapping/submaps.h"
#include "byre/slam/places/offline_map.h"
#include "byre/slam/window/paged_features.h"
#include "byre/slam/window/registration.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace byre {

// Correction of a part of the online map by its registration to the offline map.
struct OnlineCorrection {
  Submaps::Frame frame = Submaps::kMapFrame;
  std::uint32_t first_keyframe = 0;  // number of the first moved keyframe in that frame
  Pose offline_from_online;
  CorrectionShape shape = CorrectionShape::spread;
};

// The online map, and the state of mapping. A value: it changes the map by new keyframes at once, and by results of
// jobs once they are delivered. Jobs read snapshots, so they never block a change.
class Mapper {
 public:
  // vocabulary: for place recognition, may be missing. offline: map of a mission, otherwise null.
  Mapper(const Rig& rig, const MapperOptions& options, std::optional<Vocabulary> vocabulary = {},
         std::shared_ptr<const OfflineMap> offline = nullptr);

  // Jobs, for the owner to run: around new keyframes; words of new keyframes, with a loop search; on the whole map.
  JobState& local_job() { return local_; }
  JobState& index_job() { return index_; }
  JobState& map_job() { return whole_; }

  MapView map() const { return {offline_ ? &offline_->map() : nullptr, online_}; }
  const MapGraph& online() const { return online_; }
  const Submaps& submaps() const { return submaps_; }
  const PlaceIndex* places() const { return *places_ ? &**places_ : nullptr; }  // null without a vocabulary
  const std::vector<LoopEdge>& loops() const { return loop_closer_.loops(); }
  const Calibrator* calibrator() const { return calibrator_ ? &*calibrator_ : nullptr; }
  // The frame by the refined calibration; unchanged without self-calibration.
  Frame corrected(const Frame& frame) { return calibrator_ ? calibrator_->corrected(frame) : frame; }
  std::optional<KeyframeId> newest_keyframe() const { return newest_; }
  std::optional<KeyframeId> newest_in_present_frame() const;
  int pending() const { return static_cast<int>(pending_.size()); }  // keyframes not yet processed by mapping
  int revision() const { return revision_; }  // increases with each change of points or keyframes
  // The first monocular submap has the unit of the measured motion.
  bool is_scaled_by_odometry() const { return is_scaled_by_odometry_; }
  // The first monocular submap began with another motion than measured by wheels of given extrinsics.
  bool contradicts_odometry() const { return contradicts_odometry_; }
  bool has_correction() const { return waiting_correction_.has_value(); }

  void note_images(bool disagree) {  // see Calibrator
    if (calibrator_) calibrator_->note_images(disagree);
  }

  // Called before the first frame. odometry: odometry between keyframes, called on the calling thread.
  void set_odometry(OdometryQuery odometry) { odometry_ = std::move(odometry); }
  void continue_map(MapGraph online);
  void refine_calibration(const Calibration& given, const SelfCalibrationOptions& options);

  // Begins a submap with a frame. camera_from_world: pose by odometry; without it, the body's pose at the first frame
  // defines the map frame. A later submap of a monocular rig without odometry is separate: it has a frame and a scale
  // of its own, see join_submaps.
  struct Beginning {
    std::vector<KeyframeId> keyframes;  // empty if no submap was begun
    TwoViewFailure failure = TwoViewFailure::none;
  };
  Beginning begin(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                  const AnchoredTrajectory& trajectory);
  bool can_begin(const Rig& rig) const { return rig.is_stereo() || initialiser_; }
  // Allows or forbids a new monocular submap.
  void allow_monocular_submap(const Rig& rig, bool is_allowed);
  // Wheels or gyroscope give the scale of submaps: none is separate.
  void require_odometry() { needs_odometry_ = true; }
  // Whether one camera may begin a separate submap, which place recognition joins with the map later.
  bool may_begin_separate_submap() const { return places() && !offline_ && first_new_ == 0 && !needs_odometry_; }
  // Begins a submap at a relocalised frame.
  void begin_at_relocalisation(const HybridTrack& found);
  // Revokes the registration to the map frame of the present submap, or of its keyframes after a time.
  void leave_map_frame(std::optional<Timestamp> after);

  KeyframeId add_keyframe(const Frame& frame, const HybridTrack& track, const Rig& rig);
  // Called per frame unless it is tracked on offline points. Returns whether a loop was confirmed.
  bool search_loop(const LoopCloser::LoopFrame& now);
  void forget_loop() { loop_closer_.forget_hypothesis(); }
  // Called per frame, last of all: requests an index of new keyframes, with the loop search that search_loop()
  // requires, and a due job on the whole map.
  void request_jobs();

  // Called per frame, in this order. Results of jobs are applied unless a job in flight prevents it.
  std::optional<double> collect();  // seconds taken by the applied local job
  bool apply_readout_change(RollingShutterCorrector& corrector,
                            const Rig& rig);                     // applies a better readout time to keyframes
  std::optional<RigRotation> apply_calibration(const Rig& rig);  // applies a better calibration to keyframes
  std::optional<LengthChanges> apply_map_optimisation();         // applies a correction of the whole map
  void correct_later(const OnlineCorrection& correction);        // precondition: !has_correction()
  std::optional<Pose> correct_online();                          // offline_from_online of an applied correction
  void request_local_job();                                      // for pending keyframes

  void note_hidden(const ImageMask& hidden) { hidden_ = hidden; }  // see MappingOptions
  void finish_early() { *is_finishing_early_ = true; }  // a job on the whole map ends soon, with its result so far

  // Called after the last frame: finish() applies the results of all jobs, the others are the final steps. run_jobs:
  // runs the requested jobs, waits for those in flight, and delivers their results. Returned changes of length apply to
  // poses relative to keyframes.
  LengthChanges finish(const std::function<void()>& run_jobs);
  // Joins separate submaps with the map by similarities, see search_joins, and removes those that cannot be joined.
  LengthChanges join_submaps();
  // The online map without separate submaps.
  MapGraph joined_online() const;
  std::optional<RigRotation> calibrate_finally(const Rig& rig, const std::function<bool()>& should_stop);
  FinishReport finish_map(const FinishHooks& hooks);
  std::pair<LengthChanges, AdjustedOffline> adjust_with_offline(const FinishHooks& hooks);
  // Scales all lengths, once the unit of a monocular map is determined.
  LengthChanges rescale(double factor);
  // The last call; leaves an empty map.
  MapGraph take_online() { return std::exchange(online_, MapGraph(Origin::online)); }

 private:
  enum class MapJob { none, correct, calibrate };

  Beginning begin_stereo(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                         const AnchoredTrajectory& trajectory);
  Beginning begin_monocular(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                            const AnchoredTrajectory& trajectory);
  std::vector<KeyframeId> add_submap_by_odometry(const MonocularStart& start, const Pose& camera_from_world,
                                                 const AnchoredTrajectory& trajectory);
  std::vector<KeyframeId> add_submap_without_odometry(const MonocularStart& start);
  bool is_in_map(KeyframeId online) const { return submaps_.frame(online) == Submaps::kMapFrame; }
  bool join_submap(Submaps::Frame frame, LengthChanges& changes);
  std::optional<KeyframeId> parent_of_bridge(const AnchoredTrajectory& trajectory) const;
  std::vector<KeyframeMotion> motions_between(const std::vector<KeyframeId>& keyframes) const;
  std::vector<KeyframeMotion> all_motions() const;  // covers the whole map
  void apply_update(const LocalOutcome& outcome);
  RigRotation recalibrate(Recalibration by, const Rig& rig);
  void page_out_old_keyframe();
  void page_out_all();
  void page_out_later(KeyframeId id);
  void encode_later(KeyframeId id);
  void close_loop(const LoopHypothesis& loop);
  // Whether no job on the whole map is due, in flight, or finished and not applied.
  bool may_request_map_job() const { return whole_.is_idle() && !outcome_ && due_ == MapJob::none; }
  bool is_correction_waiting() const { return outcome_ && std::holds_alternative<MapCorrection>(*outcome_); }
  MapCalibration take_calibration();  // empty if none is finished
  void request_index();
  void request_map_job();
  void collect_index();
  void store(IndexedKeyframe indexed);
  void forget_places(const MapDelta& delta);
  std::uint32_t next_keyframe_number() const { return newest_ ? newest_->number + 1 : 0; }

  // Constant after construction.
  MapperOptions options_;
  std::shared_ptr<const OfflineMap> offline_;
  OdometryQuery odometry_;                                                    // empty: no odometry
  std::shared_ptr<ScratchFile> page_file_ = std::make_shared<ScratchFile>();  // written by one job at a time

  JobSlot<LocalOutcome> local_;
  JobSlot<std::vector<IndexedKeyframe>> index_;
  JobSlot<MapOutcome> whole_;
  MapJob due_ = MapJob::none;          // requested at the end of the frame
  std::optional<MapOutcome> outcome_;  // waits until no local job is in flight, whose window it would invalidate
  std::shared_ptr<std::atomic<bool>> is_finishing_early_ = std::make_shared<std::atomic<bool>>(false);  // read by jobs
  std::optional<MonocularInitialiser> initialiser_;  // while a monocular map or submap may begin
  bool is_scaled_by_odometry_ = false;
  bool contradicts_odometry_ = false;
  bool needs_odometry_ = false;
  Pose odometry_reference_;  // camera_from_world of the initialiser's reference frame, by odometry
  std::optional<Calibrator> calibrator_;
  ImageMask hidden_;
  MapGraph online_{Origin::online};
  int revision_ = 0;
  Submaps submaps_;
  Shared<std::optional<PlaceIndex>> places_;  // empty without a vocabulary
  LoopCloser loop_closer_;
  std::vector<LoopEdge> joins_;  // loops that joined submaps
  std::optional<KeyframeId> newest_;
  std::uint32_t first_new_ = 0;  // number of the first keyframe after those of a continued map
  std::vector<KeyframeId> pending_;
  ToPageOut to_page_out_;                               // for the next local job
  std::optional<OnlineCorrection> waiting_correction_;  // until no local job is in flight
  std::vector<KeyframeId> unindexed_;                   // new keyframes without words, for the next index job
  int rig_to_calibrate_ = 0;                            // index into the map's rigs
};

}  // namespace byre
