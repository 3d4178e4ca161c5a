#pragma once

#include "byre/base/scratch_file.h"
#include "byre/base/shared.h"
#include "byre/image.h"
#include "byre/map/stored_picture.h"
#include "byre/place/place_index.h"
#include "byre/slam/calibration/self_calibration.h"
#include "byre/slam/loops/global_mapping.h"
#include "byre/slam/loops/loop_closing.h"
#include "byre/slam/loops/odometry_motions.h"
#include "byre/slam/mapping/calibrator.h"
#include "byre/slam/window/mapping.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace byre {

// Jobs of mapping: functions of snapshots of the map, run in parallel with tracking. Their results are applied to the
// map of a later frame.

struct KeyframeFeatures {
  KeyframeId keyframe;
  std::shared_ptr<const Features> features;         // before paging out
  std::shared_ptr<const Features> paged = nullptr;  // copy in the scratch file
};

struct KeyframePicture {
  KeyframeId keyframe;
  std::shared_ptr<const Image> image;
  StoredPicture encoded = {};
};

// Copy of a picture in the file; the picture itself if the disk is full.
StoredPicture page_out(const StoredPicture& picture, ScratchFile& file);

// Data for a local job to write to the scratch file.
struct ToPageOut {
  std::vector<KeyframeFeatures> features;  // old keyframes
  std::vector<KeyframePicture> pictures;   // new keyframes, to be encoded before
};

// Result of a local job.
struct LocalOutcome {
  MapDelta delta;
  ToPageOut paged = {};
};
// Extends and refines the map around new keyframes, encodes pictures, and writes to the file.
LocalOutcome extend_map_locally(const MapWindow& window, const MappingOptions& options, ToPageOut to_page_out,
                                ScratchFile& page_file);

// Result of indexing a keyframe.
struct IndexedKeyframe {
  KeyframeId keyframe;
  std::vector<Word> words;  // one per feature, for place recognition
  std::optional<LoopHypothesis> loop = {};
};
// Words of keyframes that exist, in this order. Searches older parts of the map for the last one if requested.
std::vector<IndexedKeyframe> index_keyframes(const MapGraph& map, const PlaceIndex& places,
                                             const std::vector<KeyframeId>& keyframes, bool searches_loop,
                                             const LoopOptions& options);

// Result of a correction of the whole map.
struct MapCorrection {
  MapDelta delta;
  std::shared_ptr<const MapWindow> outline;  // outline of the map before the correction
};
// A refined calibration, and the correction of the map in its images after a large change.
struct CalibratedMap {
  Recalibration recalibration;
  std::optional<MapCorrection> correction;
};
// Result of a calibration by the whole map; empty if it failed or was stopped.
using MapCalibration = std::optional<CalibratedMap>;
// Result of a job on the whole map.
using MapOutcome = std::variant<MapCorrection, MapCalibration>;

// Copy of the part of a map that loop closing deforms; see recent_map.
struct LoopClosureInput {
  MapWindow recent;
  std::shared_ptr<const MapWindow> outline;  // outline of `recent`
  std::vector<LoopEdge> loops;
};
// first_new: number of the first keyframe after those of a continued map; motions: see odometry_motions.
LoopClosureInput copy_for_loop_closure(const MapGraph& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops,
                                       const std::vector<KeyframeMotion>& motions);
MapCorrection close_loops(LoopClosureInput input, const GlobalMappingOptions& options,
                          const std::function<bool()>& should_stop);

// A copy of the map to calibrate; rig: index into its rigs.
struct CalibrationInput {
  MapGraph map;
  CalibrationState state;
  int rig = 0;
  std::vector<LoopEdge> loops;
  std::vector<KeyframeMotion> motions;  // see odometry_motions
};
// Refines the calibration of a rig of the map. should_stop ends it without a result.
MapCalibration calibrate(CalibrationInput input, const SelfCalibrationOptions& options,
                         const GlobalMappingOptions& global, const std::function<bool()>& should_stop);

}  // namespace byre
