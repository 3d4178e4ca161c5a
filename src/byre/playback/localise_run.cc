#include "byre/playback/localise_run.h"

#include "byre/base/stopwatch.h"
#include "byre/features/tag_detector.h"
#include "byre/io/image/image_file.h"
#include "byre/io/image/image_names.h"
#include "byre/playback/frame_source.h"
#include "byre/slam/localisation/place_search.h"

#include <algorithm>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

Calibration best_calibration(const std::vector<SourceRecording>& recordings, const Calibration& given) {
  const auto known = stored_calibration(recordings, given);
  return known ? known->calibration : given;
}

std::vector<TagFamily> families_in(std::span<const SearchableMap> maps) {
  std::vector<MappedTag> tags;
  for (const SearchableMap& map : maps) tags.insert(tags.end(), map.map.tags().begin(), map.map.tags().end());
  return families_of(tags);
}

// Extracts features of one camera and localises each frame in the maps.
class Finder {
 public:
  Finder(std::span<const SearchableMap> maps, const Calibration& given)
      : maps_(maps), extractor_(best_calibration(maps.front().map.recordings(), given), {}, families_in(maps)) {}

  LocalisedFrame find(ImageFrame images, std::string name) {
    if (!std::ranges::all_of(maps_, &SearchableMap::is_metric)) {
      images.right.reset();
      images.depth.reset();
    }
    LocalisedFrame result;
    result.name = std::move(name);
    result.time = images.time;
    const Stopwatch extraction;
    const Frame frame = extractor_.extract(images).frame;
    result.extract_seconds = extraction.seconds();
    const Stopwatch search;
    std::vector<const OfflineMap*> maps;
    for (const SearchableMap& map : maps_) maps.push_back(&map.map);
    ImageLocalisation found = localise_image(maps, frame, extractor_.rig());
    result.localisation = std::move(found.found);
    result.localise_seconds = search.seconds();
    if (result.localisation.tracked) {
      result.map = maps_[static_cast<std::size_t>(found.map)].name;
      result.world_from_body =
          inverse(extractor_.rig().body_from_camera * result.localisation.tracked->camera_from_world);
    }
    return result;
  }

 private:
  std::span<const SearchableMap> maps_;
  Extractor extractor_;
};

// Image scaled to the camera; empty, with a warning added, if unreadable.
std::optional<Image> read_fitted(const fs::path& path, const Camera& camera, std::vector<std::string>& warnings) {
  auto [image, failure] = try_image(path);
  if (!image) {
    warnings.push_back(path.string() + ": " + failure);
    return std::nullopt;
  }
  if (image->width == camera.width && image->height == camera.height) return std::move(image);
  warnings.push_back(
      path.string() +
      fmt::format(": is of {} x {} pixels, the camera of {} x {}: scaled and cropped to the size of the camera",
                  image->width, image->height, camera.width, camera.height));
  return resize_to_cover(*image, camera.width, camera.height);
}

// Times from the names; one second apart if any name lacks a time.
std::vector<Timestamp> times_of(const std::vector<fs::path>& images) {
  std::vector<Timestamp> times;
  for (const fs::path& image : images) {
    const std::optional<Timestamp> time = time_in_name(image);
    if (!time) return uniform_times(images.size(), 1.0);
    times.push_back(*time);
  }
  return times;
}

}  // namespace

LocaliseRun localise_recording(std::span<const SearchableMap> maps, Recording& recording, const LocaliseHooks& hooks) {
  Finder finder(maps, recording.calibration());
  DecodeAhead decoder(recording);
  LocaliseRun run;
  int done = 0;
  while (std::optional<DecodedFrame> decoded = decoder.next()) {
    if (hooks.should_stop()) break;
    run.warnings.insert(run.warnings.end(), decoded->warnings.begin(), decoded->warnings.end());
    ++done;
    if (!decoded->images) continue;
    run.frames.push_back(finder.find(std::move(*decoded->images), fmt::format("{:.9f}", to_seconds(decoded->time))));
    hooks.after_frame(done, run.frames.back());
  }
  return run;
}

LocaliseRun localise_images(std::span<const SearchableMap> maps, const std::vector<fs::path>& images,
                            const Calibration& camera, const LocaliseHooks& hooks) {
  Finder finder(maps, {.left = camera.left, .right = std::nullopt, .body_from_left = camera.body_from_left});
  const std::vector<Timestamp> times = times_of(images);
  LocaliseRun run;
  for (std::size_t i = 0; i < images.size() && !hooks.should_stop(); ++i) {
    std::optional<Image> image = read_fitted(images[i], camera.left, run.warnings);
    if (!image) continue;
    ImageFrame frame{times[i], std::move(*image), std::nullopt};
    run.frames.push_back(finder.find(std::move(frame), images[i].string()));
    hooks.after_frame(static_cast<int>(i) + 1, run.frames.back());
  }
  return run;
}

}  // namespace byre
