#include "hot_loop.h"

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_mission_scene.h"
#include "byre/slam/session/session.h"
#include "byre/slam/tracking/guided_matching.h"
#include "byre/slam/tracking/mission_scene.h"

#include <benchmark/benchmark.h>

namespace byre {
namespace {

// Projects points from a slightly wrong pose and searches around the predicted pixels.
void find_expected_points(benchmark::State& state) {
  SimulationOptions options;
  options.landmarks = 12000;
  const auto mission = simulate_mission(simulated_rig(), circling_trajectory(40, 10.0, 2.0, 0.5), options);
  const MapGraph map = true_map(mission, 2, Origin::online);  // map of the even frames; the search is in an odd frame
  const MapView view(nullptr, map);
  constexpr int kFrame = 21;
  const Pose prediction_error{rotation_exp({0.003, 0.003, 0.003}), {0.01, 0.01, 0.01}};
  const Pose predicted = prediction_error * true_camera_from_world(mission, kFrame);
  const std::vector<PointId> points = map.point_ids();
  ScratchVector<PointMatch> matches;
  measure_hot_loop(state, [&] {
    const ScratchVector<ExpectedPoint> expected = project_points(view, points, predicted, mission.rig);
    matches = match_expected(*mission.frames[kFrame].features, view, expected, {});
  });
  state.counters["points"] = static_cast<double>(points.size());
  state.counters["matched"] = static_cast<double>(matches.size());
}
BENCHMARK(find_expected_points)->Unit(benchmark::kMicrosecond);

// A map of rendered images before mapping has processed its newest keyframe.
struct UnfinishedMap {
  MapGraph map{Origin::online};
  KeyframeId newest;
};

// Makes every frame a keyframe, which fills the window with few frames because rendering is slow.
SessionOptions every_frame_a_keyframe() {
  SessionOptions options;
  options.keyframes.min_frames = 1;
  options.keyframes.max_shift_share = 0.0;
  return options;
}

// The session's inline executor has run the last frame's job but applies its result in the next frame.
const UnfinishedMap& unfinished_map() {
  static const UnfinishedMap unfinished = [] {
    limit_image_threads(1);
    constexpr int kFrames = 20;
    const Calibration calibration = euroc_like_calibration(1);
    const RenderedRoom room({});
    const RenderedCameras cameras(calibration);
    Extractor extractor(calibration, {});
    Session session(extractor.rig(), every_frame_a_keyframe(), make_inline_executor());
    for (const auto& [time, pose] : circling_trajectory(kFrames, 10.0, 1.5, 0.2, calibration.body_from_left)) {
      session.process(extractor.extract(room.render(cameras, pose, time)).frame);
    }
    const MapGraph& map = session.map().online();
    return UnfinishedMap{map, map.keyframe_ids().back()};
  }();
  return unfinished;
}

void describe_window(benchmark::State& state, const MapWindow& window) {
  state.counters["keyframes"] = static_cast<double>(window.keyframes.size());
  state.counters["points"] = static_cast<double>(window.points.size());
}

void cut_window_around_newest(benchmark::State& state) {
  const UnfinishedMap& unfinished = unfinished_map();
  MapWindow window;
  measure_hot_loop(state, [&] { window = cut_window(unfinished.map, {unfinished.newest}, {}); });
  describe_window(state, window);
}
BENCHMARK(cut_window_around_newest)->Unit(benchmark::kMillisecond);

void run_mapping_job(benchmark::State& state) {
  const UnfinishedMap& unfinished = unfinished_map();
  const MapWindow window = cut_window(unfinished.map, {unfinished.newest}, {});
  MapDelta delta;
  measure_hot_loop(state, [&] { delta = extend_map(window, {}); });
  describe_window(state, window);
  state.counters["new_points"] = static_cast<double>(delta.new_points.size());
}
BENCHMARK(run_mapping_job)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace byre
