#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_mission_scene.h"
#include "byre/viewer/web/web_run.h"

#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

namespace byre {
namespace {

constexpr std::size_t kImages = 64;  // exceeds the processor's cache, because a camera's images are new each time

// A session after a few frames, and images of EuRoC's size.
struct ShownRun {
  ShownRun()
      : calibration(euroc_like_calibration(1)),
        mission(simulate_mission(simulated_rig(robot_from_camera()),
                                 circling_trajectory(5, 15.0, 2.0, 0.05, robot_from_camera()), {})),
        session(mission.rig, {}, make_inline_executor()) {
    for (const Frame& frame : mission.frames) report = session.process(frame);
    const auto pixels = static_cast<std::size_t>(calibration.left.width * calibration.left.height);
    images.assign(kImages, {calibration.left.width, calibration.left.height, std::vector<std::uint8_t>(pixels, 128)});
  }

  Calibration calibration;
  SimulatedMission mission;
  Session session;
  FrameReport report;
  std::vector<Image> images;
};

// Time of the frame thread for the viewer per frame, while the viewer's own thread runs.
void show_frame(benchmark::State& state) {
  ShownRun run;
  RunDescription description;
  description.calibration = run.calibration;
  RunViewerOptions options;
  options.server.port = 0;
  options.map_interval = std::chrono::hours(1);
  RunViewer viewer(std::move(description), options);
  std::size_t next = 0;
  for (auto _ : state) viewer.show(run.images[next++ % kImages], run.report, run.session);
}
BENCHMARK(show_frame)->Unit(benchmark::kMicrosecond)->Iterations(5000);  // bounded because all reports are kept

// Time of the map copy, once per second.
void copy_map(benchmark::State& state) {
  MapGraph map(Origin::online);
  for (int i = 0; i < state.range(0); ++i) {
    MapPoint point;
    point.position_in_world = Eigen::Vector3d(i % 100, i / 100, 1.0);
    map.add_point(point);
  }
  RunMailbox mailbox;
  for (auto _ : state) mailbox.put(scene_of(map));
}
BENCHMARK(copy_map)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace byre
