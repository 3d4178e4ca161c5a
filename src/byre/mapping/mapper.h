#pragma once

#include "byre/mapping/anchored_trajectory.h"
#include "byre/mapping/calibrator.h"
#include "byre/mapping/global_lane.h"
#include "byre/mapping/loop_closer.h"
#include "byre/mapping/mapper_options.h"
#include "byre/mapping/shutter.h"
#include "byre/mapping/submaps.h"
#include "byre/slam/hybrid_tracking.h"
#include "byre/slam/offline_map.h"
#include "byre/slam/registration.h"
#include "byre/slam/stowed_features.h"
#include "byre/slam/told_motions.h"
#include "byre/workers/worker.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Where a part of the online map really lies in the offline one.
struct OnlineCorrection {
  Submaps::Frame frame = Submaps::kMapFrame;
  std::uint32_t first_keyframe = 0;  // number of the first one in that frame that moves
  Pose offline_from_online;
  CorrectionShape shape = CorrectionShape::spread;
};

struct KeyframeFeatures {
  KeyframeId keyframe;
  std::shared_ptr<const Features> features;          // as they were
  std::shared_ptr<const Features> stowed = nullptr;  // in the file
};

// What a job in a neighbourhood comes to.
struct LocalOutcome {
  MapDelta delta;
  std::vector<KeyframeFeatures> stowed = {};
};

// What reading the map for a new keyframe comes to.
struct KeyframeReading {
  KeyframeId keyframe;
  std::vector<Word> words;  // one per feature: by these it is found again
  std::optional<LoopHypothesis> loop = {};
};

// What a job that reads the map comes to: whatever was asked for.
struct MapReading {
  std::optional<KeyframeReading> newest;
  std::optional<MapToBend> to_bend;
  std::shared_ptr<const MapWindow> whole;
};

// Where jobs of a mapper run: those in a neighbourhood, those on a copy of the whole map, and those that read the map
// itself.
struct MapperLanes {
  std::unique_ptr<Executor> local;
  std::unique_ptr<Executor> global = make_inline_executor();
  std::unique_ptr<Executor> reading = make_inline_executor();
};

// A vocabulary for places, and an offline map that the online one lies on; either may be missing.
struct MapperKnowledge {
  std::optional<Vocabulary> vocabulary;
  std::shared_ptr<const OfflineMap> offline;
};

// Owns the online map, and is the only one that changes it: with new keyframes at once, with what jobs found once they
// are done. Called from the session's thread.
class Mapper {
 public:
  Mapper(const Rig& rig, const MapperOptions& options, MapperLanes lanes, MapperKnowledge knowledge);

  MapView map() const { return {offline_ ? &offline_->map() : nullptr, online_}; }
  const Map& online() const { return online_; }
  const Submaps& submaps() const { return submaps_; }
  const PlaceIndex* places() const { return places_ ? &*places_ : nullptr; }  // index of online keyframes
  const std::vector<LoopEdge>& loops() const { return loop_closer_.loops(); }
  const Calibrator* calibrator() const { return calibrator_ ? &*calibrator_ : nullptr; }
  // The frame as the calibration that is refined has it; itself without one.
  Frame corrected(const Frame& frame) { return calibrator_ ? calibrator_->corrected(frame) : frame; }
  std::optional<KeyframeId> newest_keyframe() const { return newest_; }
  std::optional<KeyframeId> newest_in_present_frame() const;
  int pending() const { return static_cast<int>(pending_.size()); }  // keyframes that mapping has not worked on
  int revision() const { return revision_; }                         // grows whenever points or keyframes change
  bool is_read() const { return !reading_.idle(); }  // by a job, until which nothing is to change the map
  bool has_correction() const { return waiting_correction_.has_value(); }

  void note_images(bool are_at_odds) {  // see Calibrator
    if (calibrator_) calibrator_->note_images(are_at_odds);
  }

  // Whatever changes the map has the precondition !is_read().

  // Before the first frame. tell is asked by the calling thread for the ways between keyframes.
  void hear(TellMotion tell) { tell_ = std::move(tell); }
  void continue_map(Map online);
  void refine_calibration(const Calibration& given, const SelfCalibrationOptions& options);

  // Begins a submap with a frame, seen from there. In an empty map that is where the map's frame is, unless it is told
  // how the body has moved since it was there. One camera knows no scale: it begins one map, and beside another where
  // the trajectory goes on by what is told of the motion.
  struct Beginning {
    std::vector<KeyframeId> keyframes;  // empty: no submap was begun
    TwoViewFailure failure = TwoViewFailure::none;
  };
  Beginning begin(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                  const AnchoredTrajectory& trajectory);
  bool can_begin(const Rig& rig) const { return rig.is_stereo() || initialiser_; }
  // One camera may begin beside what there is where it is told how it has moved since, or, is_told being false, may
  // not.
  void expect_beginning_beside(const Rig& rig, bool is_told);
  // Begins one where a frame was found from nothing.
  void begin_where_found(const HybridTrack& found);
  // The present submap does not lie in the map's frame as was believed.
  void leave_map_frame() { submaps_.leave_map_frame(); }

  KeyframeId add_keyframe(const Frame& frame, const HybridTrack& track, const Rig& rig);
  // Once for each frame, unless offline points hold it. Whether a loop was found.
  bool look_for_loop(const LoopCloser::Look& now);
  void forget_loop() { loop_closer_.forget_hypothesis(); }
  // Once for each frame, before all else.
  void collect_reading();
  // Once for each frame, last of all: a job reads the map itself where there is need. It finds by which words a new
  // keyframe is found again, and where look_for_loop() left it open, whether that shows an older part of the map; and
  // copies the map for jobs on all of it.
  void start_reading();

  // Once for each frame, in this order, unless the map is read: what jobs came to is taken over where nothing in flight
  // stands against it.
  std::optional<double> collect();                               // seconds of the local job taken over
  bool take_over_readout(Shutter& shutter, const Rig& rig);      // keyframes seen by a better readout time
  std::optional<RigTurn> take_over_calibration(const Rig& rig);  // keyframes seen by a better calibration
  std::optional<LengthChanges> take_over_correction();           // a correction of the whole map
  void correct_later(const OnlineCorrection& correction);        // precondition: !has_correction()
  std::optional<Pose> correct_online();                          // offline_from_online of one that was carried out
  void start_job();                                              // job for pending keyframes

  void note_hidden(const HiddenCells& hidden) { hidden_ = hidden; }  // see MappingOptions
  void hurry() { global_.hurry(); }  // a correction of the whole map ends soon, with what it has reached

  // After the last frame. What jobs still have to give, then the last steps, with those changes of length that poses
  // relative to keyframes are to follow.
  LengthChanges finish();
  std::optional<RigTurn> calibrate_at_last(const Rig& rig, const std::function<bool()>& should_stop);
  FinishReport finish_map(const FinishHooks& hooks);
  LengthChanges adjust_around_offline(const FinishHooks& hooks);
  // All lengths so many times as long, as where it is known by now how long the unit of one camera's map is.
  LengthChanges stretch(double factor);
  // The last of all: it has no map after that.
  Map take_online() { return std::exchange(online_, Map(Origin::online)); }

 private:
  enum class ToCopy { nothing, to_bend, to_calibrate };  // what a job on the whole map is to get

  Beginning begin_stereo(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                         const AnchoredTrajectory& trajectory);
  Beginning begin_monocular(const Frame& frame, const Rig& rig, const std::optional<Pose>& camera_from_world,
                            const AnchoredTrajectory& trajectory);
  std::vector<KeyframeId> add_beside_map(const MonocularStart& start, const Pose& camera_from_world,
                                         const AnchoredTrajectory& trajectory);
  std::optional<KeyframeId> parent_of_bridge(const AnchoredTrajectory& trajectory) const;
  std::vector<KeyframeMotion> motions_between(const std::vector<KeyframeId>& keyframes) const;
  std::vector<KeyframeMotion> all_motions() const;  // what is told of the whole map
  void take_over(const LocalOutcome& outcome);
  RigTurn recalibrate(Recalibration by, const Rig& rig);
  void stow_old_keyframe();
  void stow_all_anew();
  void stow_later(KeyframeId id);
  void settle_loop(const LoopHypothesis& loop);
  // Whether a job on the whole map may be asked for.
  bool is_global_free() const { return global_.idle() && to_copy_ == ToCopy::nothing; }
  KeyframeReading read_for(KeyframeId id, bool looks_for_loop) const;
  void keep(KeyframeReading reading);
  void keep(MapReading reading);
  void forget_places(const MapDelta& delta);
  std::uint32_t next_keyframe_number() const { return newest_ ? newest_->number + 1 : 0; }

  // Constant after construction.
  MapperOptions options_;
  std::shared_ptr<const OfflineMap> offline_;
  TellMotion tell_;  // empty: nothing is told
  std::shared_ptr<ScratchFile> stowed_ =
      std::make_shared<ScratchFile>();  // what is put in comes from one job at a time

  Worker<LocalOutcome> local_;
  GlobalLane global_;
  std::optional<MonocularInitialiser> initialiser_;  // until there is a map, with a rig without a baseline
  Pose told_reference_;                              // camera_from_world of its reference frame, as it was told
  std::optional<Calibrator> calibrator_;
  HiddenCells hidden_;
  Map online_{Origin::online};
  int revision_ = 0;
  Submaps submaps_;
  std::optional<PlaceIndex> places_;
  LoopCloser loop_closer_;
  std::optional<KeyframeId> newest_;
  std::uint32_t first_new_ = 0;  // number of the first keyframe that is not of the map gone on with
  std::vector<KeyframeId> pending_;
  std::vector<KeyframeFeatures> to_stow_;               // what the next job is to put into the file
  std::optional<OnlineCorrection> waiting_correction_;  // until mapping has nothing in flight
  std::optional<KeyframeId> unread_;                    // the newest keyframe, while nothing has been read for it
  ToCopy to_copy_ = ToCopy::nothing;                    // until there is the copy, and the job with it
  int rig_to_calibrate_ = 0;                            // index into the map's rigs
  Worker<MapReading> reading_;                          // last, so that it ends before what it reads
};

}  // namespace byre
