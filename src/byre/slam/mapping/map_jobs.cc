#include "byre/slam/mapping/map_jobs.h"

#include "byre/features/jpeg.h"
#include "byre/slam/loops/recent_map.h"
#include "byre/slam/window/paged_features.h"

#include <utility>

namespace byre {

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

MapCalibration calibrate(const MapWindow& whole, const CalibrationState& state, int rig,
                         const SelfCalibrationOptions& options, const std::function<bool()>& should_stop) {
  const auto refined = self_calibrate(whole, state, rig, options, should_stop);
  return refined ? MapCalibration(recalibration_by(*refined, state, whole, rig)) : std::nullopt;
}

}  // namespace byre
