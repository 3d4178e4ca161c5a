#pragma once

#include "byre/base/worker.h"
#include "byre/slam/frame/hybrid_tracking.h"
#include "byre/slam/loops/odometry_motions.h"
#include "byre/slam/mapping/anchored_trajectory.h"
#include "byre/slam/mapping/calibrator.h"
#include "byre/slam/mapping/loop_closer.h"
#include "byre/slam/mapping/map_optimiser.h"
#include "byre/slam/mapping/mapper_options.h"
#include "byre/slam/mapping/rolling_shutter_corrector.h"
#include "byre/slam/mapping/submaps.h"
#include "byre/slam/places/offline_map.h"
#include "byre/slam/window/paged_features.h"
#include "byre/slam/window/registration.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Correction of a part of the online map by its registration to the offline map.
struct OnlineCorrection {
  Submaps::Frame frame = Submaps::kMapFrame;
  std::uint32_t first_keyframe = 0;  // number of the first moved keyframe in that frame
  Pose offline_from_online;
  CorrectionShape shape = CorrectionShape::spread;
};

struct KeyframeFeatures {
  KeyframeId keyframe;
  std::shared_ptr<const Features> features;         // before paging out
  std::shared_ptr<const Features> paged = nullptr;  // copy in the scratch file
};

// Result of a local job.
struct LocalOutcome {
  MapDelta delta;
  std::vector<KeyframeFeatures> paged = {};
};

// Result of reading the map for a new keyframe.
struct KeyframeReading {
  KeyframeId keyframe;
  std::vector<Word> words;  // one per feature, for place recognition
  std::optional<LoopHypothesis> loop = {};
};

// Result of a reading job; empty parts were not requested.
struct MapReading {
  std::optional<KeyframeReading> newest;
  std::optional<LoopClosureInput> to_correct;
  std::shared_ptr<const MapWindow> whole;
};

// Executors of a mapper's jobs: in a local window, on a copy of the whole map, and reading the map itself.
struct MapperExecutors {
  std::unique_ptr<Executor> local;
  std::unique_ptr<Executor> global = make_inline_executor();
  std::unique_ptr<Executor> reading = make_inline_executor();
};

// Vocabulary for place recognition, and offline map of a mission; each may be missing.
struct MapperResources {
  std::optional<Vocabulary> vocabulary;
  std::shared_ptr<const OfflineMap> offline;
};

// Owner of the online map, which it alone changes: by new keyframes at once, by jobs when they finish. Called from the
// session's thread.
class Mapper {
 public:
  Mapper(const Rig& rig, const MapperOptions& options, MapperExecutors executors, MapperResources resources);

  MapView map() const { return {offline_ ? &offline_->map() : nullptr, online_}; }
  const Map& online() const { return online_; }
  const Submaps& submaps() const { return submaps_; }
  const PlaceIndex* places() const { return places_ ? &*places_ : nullptr; }  // null without a vocabulary
  const std::vector<LoopEdge>& loops() const { return loop_closer_.loops(); }
  const Calibrator* calibrator() const { return calibrator_ ? &*calibrator_ : nullptr; }
  // The frame by the refined calibration; unchanged without self-calibration.
  Frame corrected(const Frame& frame) { return calibrator_ ? calibrator_->corrected(frame) : frame; }
  std::optional<KeyframeId> newest_keyframe() const { return newest_; }
  std::optional<KeyframeId> newest_in_present_frame() const;
  int pending() const { return static_cast<int>(pending_.size()); }  // keyframes not yet processed by mapping
  int revision() const { return revision_; }               // increases with each change of points or keyframes
  bool is_being_read() const { return !reading_.idle(); }  // by a job; the map must not change meanwhile
  bool has_correction() const { return waiting_correction_.has_value(); }

  void note_images(bool disagree) {  // see Calibrator
    if (calibrator_) calibrator_->note_images(disagree);
  }

  // Methods below that change the map have the precondition !is_being_read().

  // Called before the first frame. odometry: odometry between keyframes, called on the calling thread.
  void set_odometry(OdometryQuery odometry) { odometry_ = std::move(odometry); }
  void continue_map(Map online);
  void refine_calibration(const Calibration& given, const SelfCalibrationOptions& options);

  // Begins a submap with a frame. camera_from_world: pose by odometry; without it, the body's pose at the first frame
  // defines the map frame. A monocular rig needs odometry for the scale of all but its first submap.
  struct Beginning {
    std::vector<KeyframeId> keyframes;  // empty if no submap was begun
    TwoViewFailure failure = TwoViewFailure::none;
  };
  Beginning begin(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                  const AnchoredTrajectory& trajectory);
  bool can_begin(const Rig& rig) const { return rig.is_stereo() || initialiser_; }
  // Allows a new monocular submap if odometry is available (has_odometry), which its scale needs; else forbids it.
  void allow_monocular_submap(const Rig& rig, bool has_odometry);
  // Begins a submap at a relocalised frame.
  void begin_at_relocalisation(const HybridTrack& found);
  // Revokes the registration of the present submap to the map frame.
  void leave_map_frame() { submaps_.leave_map_frame(); }

  KeyframeId add_keyframe(const Frame& frame, const HybridTrack& track, const Rig& rig);
  // Called per frame unless it is tracked on offline points. Returns whether a loop was confirmed.
  bool search_loop(const LoopCloser::LoopFrame& now);
  void forget_loop() { loop_closer_.forget_hypothesis(); }
  // Called per frame, before all else.
  void collect_reading();
  // Called per frame, last of all: starts a job that reads the map if necessary. The job computes the words of a new
  // keyframe, searches older parts of the map for it if search_loop() requested this, and makes copies for global
  // jobs.
  void start_reading();

  // Called per frame, in this order, unless is_being_read(). Results of jobs are applied unless a job in flight
  // prevents it.
  std::optional<double> collect();  // seconds taken by the applied local job
  bool apply_readout_change(RollingShutterCorrector& corrector,
                            const Rig& rig);                     // applies a better readout time to keyframes
  std::optional<RigRotation> apply_calibration(const Rig& rig);  // applies a better calibration to keyframes
  std::optional<LengthChanges> apply_map_optimisation();         // applies a correction of the whole map
  void correct_later(const OnlineCorrection& correction);        // precondition: !has_correction()
  std::optional<Pose> correct_online();                          // offline_from_online of an applied correction
  void start_job();                                              // for pending keyframes

  void note_hidden(const ImageMask& hidden) { hidden_ = hidden; }  // see MappingOptions
  void finish_early() { global_.finish_early(); }  // a correction of the whole map ends soon, with its result so far

  // Called after the last frame: finish() applies the results of jobs in flight, the others are the final steps.
  // Returned changes of length apply to poses relative to keyframes.
  LengthChanges finish();
  std::optional<RigRotation> calibrate_finally(const Rig& rig, const std::function<bool()>& should_stop);
  FinishReport finish_map(const FinishHooks& hooks);
  LengthChanges adjust_around_offline(const FinishHooks& hooks);
  // Scales all lengths, once the unit of a monocular map is determined.
  LengthChanges rescale(double factor);
  // The last call; leaves an empty map.
  Map take_online() { return std::exchange(online_, Map(Origin::online)); }

 private:
  enum class ToCopy { nothing, to_correct, to_calibrate };  // the copy that a job on the whole map needs

  Beginning begin_stereo(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                         const AnchoredTrajectory& trajectory);
  Beginning begin_monocular(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                            const AnchoredTrajectory& trajectory);
  std::vector<KeyframeId> add_submap_by_odometry(const MonocularStart& start, const Pose& camera_from_world,
                                                 const AnchoredTrajectory& trajectory);
  std::optional<KeyframeId> parent_of_bridge(const AnchoredTrajectory& trajectory) const;
  std::vector<KeyframeMotion> motions_between(const std::vector<KeyframeId>& keyframes) const;
  std::vector<KeyframeMotion> all_motions() const;  // covers the whole map
  void apply_update(const LocalOutcome& outcome);
  RigRotation recalibrate(Recalibration by, const Rig& rig);
  void page_out_old_keyframe();
  void page_out_all();
  void page_out_later(KeyframeId id);
  void close_loop(const LoopHypothesis& loop);
  // Whether a job on the whole map may be requested.
  bool is_global_free() const { return global_.idle() && to_copy_ == ToCopy::nothing; }
  KeyframeReading index_keyframe(KeyframeId id, bool searches_loop) const;
  void store(KeyframeReading reading);
  void store(MapReading reading);
  void forget_places(const MapDelta& delta);
  std::uint32_t next_keyframe_number() const { return newest_ ? newest_->number + 1 : 0; }

  // Constant after construction.
  MapperOptions options_;
  std::shared_ptr<const OfflineMap> offline_;
  OdometryQuery odometry_;                                                    // empty: no odometry
  std::shared_ptr<ScratchFile> page_file_ = std::make_shared<ScratchFile>();  // written by one job at a time

  Worker<LocalOutcome> local_;
  MapOptimiser global_;
  std::optional<MonocularInitialiser> initialiser_;  // while a monocular map or submap may begin
  Pose odometry_reference_;  // camera_from_world of the initialiser's reference frame, by odometry
  std::optional<Calibrator> calibrator_;
  ImageMask hidden_;
  Map online_{Origin::online};
  int revision_ = 0;
  Submaps submaps_;
  std::optional<PlaceIndex> places_;
  LoopCloser loop_closer_;
  std::optional<KeyframeId> newest_;
  std::uint32_t first_new_ = 0;  // number of the first keyframe after those of a continued map
  std::vector<KeyframeId> pending_;
  std::vector<KeyframeFeatures> to_page_out_;           // for the next job to write to the file
  std::optional<OnlineCorrection> waiting_correction_;  // until no local job is in flight
  std::optional<KeyframeId> unindexed_;                 // the newest keyframe, until a job reads the map for it
  ToCopy to_copy_ = ToCopy::nothing;                    // until the copy is made and its job started
  int rig_to_calibrate_ = 0;                            // index into the map's rigs
  Worker<MapReading> reading_;                          // last member: ends before the data that it reads
};

}  // namespace byre
