#include "aligned_map.h"

#include "mapped_recording.h"

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/input_error.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/map/keyframe_path.h"
#include "byre/map/map_file.h"
#include "byre/place/map_words.h"
#include "byre/slam/system/slam_impl.h"
#include "byre/slam/window/map_from_poses.h"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Location of rendered recordings, and the file that rendering writes last.
struct RenderedFolder {
  const char* variable;  // environment variable with the folder
  const char* cached;    // default folder in ~/.cache/byre
  const char* last_file;
};

const RenderedFolder& rendered_folder(Source source) {
  static constexpr RenderedFolder kTwin{"BYRE_TWIN", "twin", "twin.yaml"};
  static constexpr RenderedFolder kBarns{"BYRE_BARNS", "barns", "complete"};
  return source == Source::twin ? kTwin : kBarns;
}

fs::path rendered_path(const RecordingName& name) {
  const RenderedFolder& folder = rendered_folder(name.source);
  if (const char* const named = std::getenv(folder.variable)) return fs::path(named) / name.name;
  const char* const home = std::getenv("HOME");
  return fs::path(home != nullptr ? home : "/") / ".cache" / "byre" / folder.cached / name.name;
}

fs::path folder_of(const RecordingName& name) {
  if (const auto folder = find(name)) return *folder;
  throw InputError(name.name, "is not available", why_missing(name));
}

// Reads and extracts the frames of an imperfect camera.
class MapFrames {
 public:
  MapFrames(Recording& recording, const Imperfection& imperfection)
      : recording_(recording),
        cameras_(imperfect_cameras(imperfection)),
        extractor_(nominal_calibration(recording.calibration(), imperfection), {}) {
    limit_image_threads(1);
  }

  const Rig& rig() const { return extractor_.rig(); }

  // Empty for unreadable images.
  std::optional<Frame> read(int index) {
    const auto images = recording_.read(index);
    return images ? std::optional(extractor_.extract(cameras_(*images, index)).frame) : std::nullopt;
  }

 private:
  Recording& recording_;
  Degradation cameras_;
  Extractor extractor_;
};

// A map and its refined calibration.
struct BuiltMap {
  MapGraph map;
  std::optional<RefinedCalibration> refined{};
};

BuiltMap map_by_session(Recording& recording, const Imperfection& imperfection) {
  MapFrames frames(recording, imperfection);
  MethodOptions options;
  options.pace = Pace::same_thread;
  SlamImpl slam(nominal_calibration(recording.calibration(), imperfection), options,
                {.vocabulary = mission_vocabulary()});
  for (int i = 0; i < recording.size(); ++i) {
    if (const auto frame = frames.read(i)) slam.process(*frame);
  }
  slam.finish({[] { return false; }, {}});
  return {slam.online(), slam.calibration()};
}

BuiltMap map_by_true_poses(Recording& recording, const Trajectory& truth, const Imperfection& imperfection) {
  MapFrames frames(recording, imperfection);
  std::vector<PosedFrame> posed;
  for (int i = 0; i < recording.size(); ++i) {
    const auto frame = frames.read(i);
    const auto world_from_body = frame ? pose_at(truth, frame->time, std::chrono::milliseconds(60)) : std::nullopt;
    if (world_from_body) posed.push_back({*frame, inverse(*world_from_body * frames.rig().body_from_camera)});
  }
  return {map_from_poses({frames.rig()}, posed, {})};
}

fs::path cache_file(const MapRecipe& recipe) {
  return fs::temp_directory_path() / "byre_mission_maps" / (name_of(recipe) + ".byre");
}

StoredMap make_map(const MapRecipe& recipe) {
  const fs::path folder = folder_of(recipe.recording);
  const auto recording = open_recording(folder, recipe.range);
  StoredMap stored;
  const BuiltMap made = recipe.from_true_poses
                            ? map_by_true_poses(*recording, truth_of(recipe.recording), recipe.imperfection)
                            : map_by_session(*recording, recipe.imperfection);
  stored.map = offline_copy(made.map);
  stored.pose_source = recipe.from_true_poses ? PoseSource::given : PoseSource::slam;
  const Calibration nominal = nominal_calibration(recording->calibration(), recipe.imperfection);
  stored.recordings = {
      {folder.filename().string(), nominal, recording->times().front(), recording->times().back(), made.refined}};
  add_words(stored, mission_vocabulary());
  return stored;
}

// Empty when there is no map that this version can read.
std::optional<StoredMap> load_cached(const fs::path& file) {
  try {
    StoredMap stored = load_map(file);
    add_words(stored, mission_vocabulary());
    return stored;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

StoredMap load_or_build(const MapRecipe& recipe) {
  const fs::path file = cache_file(recipe);
  if (std::optional<StoredMap> cached = load_cached(file)) return std::move(*cached);
  StoredMap stored = make_map(recipe);
  fs::create_directories(file.parent_path());
  save_map(stored, file);
  return stored;
}

Similarity truth_from(const MapGraph& map, const Trajectory& truth) {
  const MapAlignment alignment = align_to_truth(keyframe_path(map), Scale::fixed, truth);
  if (alignment.poses == 0) throw InputError("map", "cannot be aligned to the truth of its recording");
  return alignment.truth_from_map;
}

AlignedMap with(MapGraph map, const AlignedMap& aligned) {
  return {std::make_shared<const OfflineMap>(std::move(map), mission_vocabulary(), aligned.map->recordings()),
          aligned.truth_from_map};
}

}  // namespace

std::optional<fs::path> find(const RecordingName& name) {
  if (name.source == Source::real) return find_recording(name.name);
  const fs::path folder = rendered_path(name);
  return fs::is_regular_file(folder / rendered_folder(name.source).last_file) ? std::optional(folder) : std::nullopt;
}

std::string why_missing(const RecordingName& name) {
  if (name.source == Source::real) return missing(name.name);
  const std::string remedy =
      name.source == Source::barn ? "render it by tests/missions/render_barns.sh, or set " : "set ";
  return "no complete recording at " + rendered_path(name).string() + "; " + remedy +
         rendered_folder(name.source).variable + " to the folder with " + name.name;
}

std::string name_of(const MapRecipe& recipe) {
  std::string name = recipe.recording.name;
  if (recipe.range.last) name += "_to_" + std::to_string(*recipe.range.last);
  if (recipe.imperfection.condition != CameraCondition::exact) name += "_" + name_of(recipe.imperfection);
  std::ranges::replace(name, '/', '_');
  return name;
}

Trajectory truth_of(const RecordingName& name) {
  Trajectory truth = load_truth(folder_of(name));
  for (StampedPose& pose : truth) pose.time += name.truth_offset;
  return truth;
}

const Vocabulary& mission_vocabulary() {
  static const Vocabulary loaded = Vocabulary::load(default_vocabulary_path());
  return loaded;
}

AlignedMap make_aligned_map(const MapRecipe& recipe) {
  StoredMap stored = load_or_build(recipe);
  const Similarity truth_from_map = truth_from(stored.map, truth_of(recipe.recording));
  return {std::make_shared<const OfflineMap>(std::move(stored.map), mission_vocabulary(), std::move(stored.recordings)),
          truth_from_map};
}

AlignedMap without_stretch(const AlignedMap& aligned, Timestamp from, Timestamp to) {
  MapGraph map = aligned.map->map();
  const std::vector<KeyframeId> keyframes = map.keyframe_ids();
  const Timestamp begin = map.find_keyframe(keyframes.front())->frame.time;
  const auto is_in_stretch = [&](KeyframeId id) {
    const Timestamp time = map.find_keyframe(id)->frame.time - begin;
    return from <= time && time < to;
  };
  for (const PointId id : map.point_ids()) {
    const std::vector<Observation>& observations = map.observations(id);
    const auto inside = std::ranges::count_if(
        observations, [&](const Observation& observation) { return is_in_stretch(observation.keyframe); });
    if (2 * inside > std::ssize(observations)) map.remove_point(id);
  }
  for (const KeyframeId id : keyframes) {
    if (is_in_stretch(id)) map.remove_keyframe(id);
  }
  return with(std::move(map), aligned);
}

AlignedMap without_points(const AlignedMap& aligned, double share, std::uint64_t seed) {
  MapGraph map = aligned.map->map();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  for (const PointId id : map.point_ids()) {
    if (any(random) < share) map.remove_point(id);
  }
  return with(std::move(map), aligned);
}

}  // namespace byre
