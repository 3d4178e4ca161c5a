#include "hot_loop.h"

#include "byre/simulation/simulated_mission_scene.h"
#include "byre/slam/session/session.h"

#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <benchmark/benchmark.h>

namespace byre {
namespace {

constexpr int kKeyframesOfHall = 100;
constexpr int kHalls = 20;
constexpr double kFrameRateHz = 10.0;
constexpr std::size_t kFramesBefore = 10;  // frames of a mission before the measurement

// A lap through one of several halls, which share no landmarks.
SimulatedMission lap(int hall, std::uint64_t noise_seed) {
  SimulationOptions options;
  options.landmarks = 12000;
  options.seed = static_cast<std::uint64_t>(hall) + 1;
  options.noise_seed = noise_seed;
  return simulate_mission(simulated_rig(), circling_trajectory(kKeyframesOfHall, kFrameRateHz, 2.0, 1.0), options);
}

// Appends a lap, with its hall placed next to the others.
void append(const SimulatedMission& lap, int hall, SimulatedMission& building) {
  const Eigen::Vector3d offset(20.0 * hall, 0.0, 0.0);
  const Timestamp time_offset = hall * (lap.frames.back().time - lap.frames.front().time + std::chrono::seconds(1));
  const int first_landmark = static_cast<int>(building.landmarks_in_world.size());
  for (std::size_t i = 0; i < lap.frames.size(); ++i) {
    const Pose& pose = lap.truth[i].world_from_body;
    building.truth.push_back({lap.truth[i].time + time_offset, {pose.rotation, pose.translation + offset}});
    building.frames.push_back({lap.frames[i].time + time_offset, lap.frames[i].features});
    std::vector<int> landmarks = lap.landmark_of_feature[i];
    for (int& landmark : landmarks) landmark += landmark < 0 ? 0 : first_landmark;
    building.landmark_of_feature.push_back(std::move(landmarks));
  }
  for (const Eigen::Vector3d& landmark : lap.landmarks_in_world) {
    building.landmarks_in_world.push_back(landmark + offset);
  }
}

const Vocabulary& vocabulary() {
  static const Vocabulary trained = [] {
    std::vector<std::vector<Descriptor>> images;
    for (const Frame& frame : lap(0, 1).frames) images.push_back(to_vector(frame.features->descriptors()));
    return Vocabulary::train(images, {.branching = 10, .depth = 4, .rounds = 3, .seed = 1});
  }();
  return trained;
}

// The map of the first halls with this number of keyframes; every frame of a lap is a keyframe.
std::shared_ptr<const OfflineMap> map_of(int keyframes) {
  static std::map<int, std::shared_ptr<const OfflineMap>> made;
  if (made.contains(keyframes)) return made[keyframes];
  SimulatedMission building;
  building.rig = simulated_rig();
  for (int hall = 0; hall < keyframes / kKeyframesOfHall; ++hall) append(lap(hall, 1), hall, building);
  MapGraph map = true_map(building, 1, Origin::offline);
  for (const KeyframeId id : map.keyframe_ids()) {
    map.set_words(id, vocabulary().words_of(*map.find_keyframe(id)->frame.features));
  }
  return made[keyframes] = std::make_shared<const OfflineMap>(std::move(map), vocabulary());
}

Session session_on(const std::shared_ptr<const OfflineMap>& offline) {
  return {simulated_rig(), {}, SessionExecutors(make_inline_executor(), make_inline_executor()), vocabulary(), offline};
}

// A second lap through the first hall, localised and tracked; the argument is the number of keyframes of the offline
// map.
void track_mission(benchmark::State& state) {
  const auto offline = map_of(static_cast<int>(state.range(0)));
  const SimulatedMission mission = lap(0, 2);
  std::optional<Session> session;
  std::size_t next = 0;
  const auto begin = [&] {
    session.emplace(session_on(offline));
    for (next = 0; next < kFramesBefore; ++next) session->process(mission.frames[next]);
  };
  begin();
  int processed = 0, tracked = 0;
  measure_hot_loop(state, [&] {
    if (next == mission.frames.size()) {
      state.PauseTiming();
      begin();
      state.ResumeTiming();
    }
    tracked += session->process(mission.frames[next++]).map_from_body ? 1 : 0;
    ++processed;
  });
  state.counters["offline_points"] = offline->map().point_count();
  state.counters["tracked_share"] = static_cast<double>(tracked) / processed;
}
BENCHMARK(track_mission)->Arg(kKeyframesOfHall)->Arg(kHalls* kKeyframesOfHall)->Unit(benchmark::kMillisecond);

// Localisation of one frame without a prior.
void find_itself_in_the_map(benchmark::State& state) {
  const auto offline = map_of(static_cast<int>(state.range(0)));
  const SimulatedMission mission = lap(0, 2);
  for (auto _ : state) benchmark::DoNotOptimize(localise_in(*offline, {mission.frames[50], mission.rig}, {}));
}
BENCHMARK(find_itself_in_the_map)->Arg(kKeyframesOfHall)->Arg(kHalls* kKeyframesOfHall)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace byre
