#include "byre/slam/mapping/map_jobs.h"

#include "byre/features/jpeg.h"
#include "byre/slam/loops/recent_map.h"
#include "byre/slam/window/paged_features.h"

#include <utility>

namespace byre {
namespace {

// The solution of a self-calibration as a change of the map. The covariances stay until the next adjustment.
MapDelta geometry_of(const MapWindow& whole, const SelfCalibration& solved) {
  MapDelta delta;
  for (const auto& [index, camera_from_world] : solved.keyframes_moved) {
    const WindowKeyframe& keyframe = whole.keyframe(index);
    delta.moved_keyframes.push_back({{keyframe.id.number}, camera_from_world, keyframe.keyframe.covariance});
  }
  for (const auto& [index, position_in_world] : solved.points_moved) {
    const WindowPoint& point = whole.point(index);
    delta.updated_points.push_back({{point.id->number}, point.point});
    delta.updated_points.back().point.position_in_world = position_in_world;
  }
  return delta;
}

}  // namespace

StoredPicture page_out(const StoredPicture& picture, ScratchFile& file) {
  const std::vector<std::byte> jpeg = picture.jpeg();
  const std::shared_ptr<const std::byte> place = jpeg.empty() ? nullptr : file.put(jpeg);
  if (!place) return picture;
  return {jpeg.size(), [place, size = jpeg.size()] { return std::vector(place.get(), place.get() + size); }};
}

LocalOutcome extend_map_locally(const MapWindow& window, const MappingOptions& options, ToPageOut to_page_out,
                                ScratchFile& page_file) {
  LocalOutcome outcome{extend_map(window, options), std::move(to_page_out)};
  for (KeyframeFeatures& of : outcome.paged.features) of.paged = page_out(of.features, page_file);
  for (KeyframePicture& of : outcome.paged.pictures) {
    of.encoded = page_out(StoredPicture(encode_jpeg(*of.image, StoredPicture::kMadeBytes)), page_file);
    of.image.reset();
  }
  page_file.release_pages();
  return outcome;
}

std::vector<IndexedKeyframe> index_keyframes(const MapGraph& map, const PlaceIndex& places,
                                             const std::vector<KeyframeId>& keyframes, bool searches_loop,
                                             const LoopOptions& options) {
  std::vector<IndexedKeyframe> indexed;
  for (const KeyframeId id : keyframes) {
    indexed.push_back({id, places.vocabulary().words_of(*map.find_keyframe(id)->frame.features)});
  }
  if (searches_loop && !indexed.empty()) {
    IndexedKeyframe& newest = indexed.back();
    newest.loop = find_loop_by_words(map, places, newest.keyframe, newest.words, options);
  }
  return indexed;
}

LoopClosureInput copy_for_loop_closure(const MapGraph& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops,
                                       const std::vector<KeyframeMotion>& motions) {
  MapWindow recent = recent_map(map, first_new, loops);
  add_motions(recent, motions);
  auto outline = std::make_shared<const MapWindow>(outline_of(recent));
  return {std::move(recent), std::move(outline), loops};
}

MapCorrection close_loops(LoopClosureInput input, const GlobalMappingOptions& options,
                          const std::function<bool()>& should_stop) {
  MapDelta delta = adjust_map(std::move(input.recent), *input.outline, input.loops, options, should_stop);
  return {std::move(delta), std::move(input.outline)};
}

MapCalibration calibrate(CalibrationInput input, const SelfCalibrationOptions& options,
                         const GlobalMappingOptions& global, const std::function<bool()>& should_stop) {
  constexpr double kToAdjust = 0.5;  // sigmas of the parameters; smaller changes move the map by less than its noise
  auto whole = std::make_unique<const MapWindow>(whole_map(input.map));
  const auto refined = self_calibrate(*whole, input.state, input.rig, options, should_stop);
  if (!refined) return std::nullopt;
  CalibratedMap result{recalibration_by(*refined, input.state, *whole, input.rig), {}};
  if ((refined->change - input.state.change).norm() <= kToAdjust) return result;
  const MapDelta solved = geometry_of(*whole, *refined);
  whole.reset();  // its memory is needed
  input.map.recalibrate(input.rig, result.recalibration.from_present, result.recalibration.features);
  auto before = std::make_shared<const MapWindow>(outline_of(whole_map(input.map)));
  apply(solved, input.map);
  LoopClosureInput adjusted = copy_for_loop_closure(input.map, 0, input.loops, input.motions);
  adjusted.outline = std::move(before);
  result.correction = close_loops(std::move(adjusted), global, should_stop);
  return result;
}

}  // namespace byre
