#include "byre/features/extract.h"
#include "byre/features/image_view.h"
#include "byre/features/tag_detector.h"
#include "byre/input_error.h"
#include "byre/map.h"
#include "byre/map/map_file.h"
#include "byre/place/map_words.h"
#include "byre/slam/localisation/place_search.h"
#include "byre/slam/system/input_check.h"
#include "byre/slam/system/stored_map.h"
#include "byre/slam/tracking/body_pose.h"

namespace byre {
namespace {

Calibration calibration_in(const StoredMap& stored, const std::optional<Calibration>& given) {
  if (given) {
    const auto refined = stored_calibration(stored.recordings, *given);
    return refined ? refined->calibration : *given;
  }
  if (!stored.recordings.empty()) return stored.recordings.back().present_calibration();
  throw InputError("map", "does not contain the calibration of its camera, so images cannot be localised in it",
                   "give the calibration of the camera");
}

StoredMap with_words(StoredMap stored, const Vocabulary& vocabulary) {
  if (stored.map.keyframe_count() == 0)
    throw InputError("map", "contains no keyframes, so images cannot be localised in it", "map a recording first");
  add_words(stored, vocabulary);
  return stored;
}

}  // namespace

struct Localiser::State {
  // Precondition: stored was made by with_words().
  State(const StoredMap& stored, const std::optional<Calibration>& given, const Vocabulary& vocabulary)
      : is_metric(stored.scale == MapScale::metric),
        map(stored.map, vocabulary, stored.recordings, {}, {}, stored_tags(stored.notes)),
        calibration(calibration_in(stored, given)),
        extractor(calibration, {}, families_of(map.tags())) {}

  ImageFrame images_of(const CameraImages& images) const;

  bool is_metric;
  OfflineMap map;
  Calibration calibration;
  Extractor extractor;
};

ImageFrame Localiser::State::images_of(const CameraImages& images) const {
  InputCheck check(calibration, extractor.rig(), {});
  if (const InputFault fault = check.note(images); is_dropped(fault)) {
    throw InputError("image", "cannot be localised: " + std::string(to_string(fault)),
                     "give images of the calibrated size and kind");
  }
  ImageFrame frame{images.left.time, {}, std::nullopt};
  copy_grey(images.left, frame.left);
  // Disparities are comparable with a metric map only.
  if (is_metric && check.may_use_right()) copy_grey(*images.right, frame.right.emplace());
  if (is_metric && check.may_use_depth()) {
    copy_depth(*images.depth, calibration.depth->units_per_metre, frame.depth.emplace());
  }
  return frame;
}

Localiser::Localiser(const Map& map, const std::optional<Calibration>& calibration,
                     const std::optional<std::filesystem::path>& vocabulary)
    : state_([&] {
        const Vocabulary words = open_vocabulary(vocabulary);
        return std::make_unique<State>(with_words(map.stored(), words), calibration, words);
      }()) {}

Localiser::Localiser(Localiser&&) noexcept = default;
Localiser& Localiser::operator=(Localiser&&) noexcept = default;
Localiser::~Localiser() = default;

LocalisationReport Localiser::localise(const CameraImages& images) {
  State& state = *state_;
  const Rig& rig = state.extractor.rig();
  const Frame frame = state.extractor.extract(state.images_of(images)).frame;
  const OfflineMap* const map = &state.map;
  const Localisation found = localise_image({&map, 1}, frame, rig).found;
  LocalisationReport report;
  report.failure = found.failure;
  report.inliers = found.inliers;
  if (!found.tracked) return report;
  report.map_from_body = body_pose(rig, found.tracked->camera_from_world);
  report.covariance = move_covariance(found.tracked->covariance, rig.body_from_camera);
  report.inliers = static_cast<int>(found.tracked->features.size());
  return report;
}

}  // namespace byre
