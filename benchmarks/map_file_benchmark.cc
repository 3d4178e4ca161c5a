#include "byre/map/map_file.h"
#include "byre/simulation/simulated_mission_scene.h"

#include <memory>

#include <benchmark/benchmark.h>

namespace byre {
namespace {

constexpr int kRooms = 11;
constexpr int kKeyframesPerRoom = 91;

// A map of one room: about 9,300 points, each keyframe with up to 1000 features.
MapGraph room_map(int room) {
  SimulationOptions options;
  options.landmarks = 25000;
  options.room_size = {20.0, 16.0, 4.0};
  options.seed = options.noise_seed = static_cast<std::uint64_t>(room + 1);
  const Trajectory path = circling_trajectory(kKeyframesPerRoom, 2.0, 5.0, 1.0);
  return true_map(simulate_mission(simulated_rig(), path, options), 1, Origin::offline);
}

// Simulated features have no patches; adds them to features that define a point, as mapping stores them.
std::shared_ptr<const Features> with_patches(const MapGraph& map, KeyframeId id) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  std::vector<Patch> patches;
  std::vector<int> patch_of_keypoint(keyframe.sightings.size(), -1);
  for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
    const std::optional<PointId> point = keyframe.sightings[i].point;
    if (!point || map.find_point(*point)->reference != Observation{id, static_cast<int>(i)}) continue;
    patch_of_keypoint[i] = static_cast<int>(patches.size());
    patches.emplace_back().centre.setConstant(Patch::kSize / 2);
  }
  const Features& features = *keyframe.frame.features;
  return std::make_shared<const Features>(rig.width, rig.height, to_vector(features.keypoints()),
                                          to_vector(features.descriptors()), patches, patch_of_keypoint);
}

void add_room(const MapGraph& room, MapParts& parts) {
  const auto first_keyframe = static_cast<std::uint32_t>(parts.keyframes.size());
  const auto first_point = static_cast<std::uint32_t>(parts.points.size());
  for (const KeyframeId id : room.keyframe_ids()) {
    Keyframe keyframe = *room.find_keyframe(id);
    keyframe.frame.features = with_patches(room, id);
    keyframe.words.resize(keyframe.sightings.size());
    if (keyframe.parent) keyframe.parent->number += first_keyframe;
    for (Sighting& sighting : keyframe.sightings) {
      if (sighting.point) sighting.point = PointId{Origin::offline, sighting.point->number + first_point};
    }
    parts.keyframes.push_back(std::move(keyframe));
  }
  for (const PointId id : room.point_ids()) {
    parts.points.push_back(*room.find_point(id));
    parts.points.back().reference.keyframe.number += first_keyframe;
  }
}

// A building of eleven rooms: about 1,000 keyframes and 100,000 points.
const StoredMap& building() {
  static const StoredMap stored = [] {
    StoredMap made;
    Camera camera;
    camera.width = 752;
    camera.height = 480;
    camera.fx = camera.fy = 400.0;
    made.recordings.push_back({"building", {camera, std::nullopt, {}}});
    made.vocabulary_checksum = 1;
    MapParts parts{{simulated_rig()}, {}, {}};
    for (int room = 0; room < kRooms; ++room) add_room(room_map(room), parts);
    made.map = MapGraph(Origin::offline, std::move(parts));
    return made;
  }();
  return stored;
}

std::filesystem::path building_file() {
  return std::filesystem::temp_directory_path() / "byre_benchmark.byre";
}

void count_contents(benchmark::State& state) {
  const double keyframes = building().map.keyframe_count();
  state.counters["keyframes"] = keyframes;
  state.counters["points"] = building().map.point_count();
  state.counters["bytes_per_keyframe"] = static_cast<double>(std::filesystem::file_size(building_file())) / keyframes;
}

// The file is in the page cache.
void load_map_file(benchmark::State& state) {
  save_map(building(), building_file());
  for (auto _ : state) benchmark::DoNotOptimize(load_map(building_file()));
  count_contents(state);
  std::filesystem::remove(building_file());
}
BENCHMARK(load_map_file)->Unit(benchmark::kMillisecond);

void save_map_file(benchmark::State& state) {
  building();
  for (auto _ : state) save_map(building(), building_file());
  count_contents(state);
  std::filesystem::remove(building_file());
}
BENCHMARK(save_map_file)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace byre
