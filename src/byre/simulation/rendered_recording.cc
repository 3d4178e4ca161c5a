#include "byre/simulation/euroc_writer.h"
#include "byre/simulation/rendered_room.h"

namespace byre {

void write_euroc_recording(const RenderedRoom& room, const Calibration& calibration, const Trajectory& truth,
                           const std::filesystem::path& folder,
                           const std::function<void(int done, int total)>& progress) {
  std::vector<Timestamp> times;
  for (const StampedPose& sample : truth) times.push_back(sample.time);
  const EurocWriter writer(calibration, times, truth, folder);
  const RenderedCameras cameras(calibration);
  const int total = static_cast<int>(truth.size());
  for (int i = 0; i < total; ++i) {
    const auto& [time, world_from_body] = truth[static_cast<std::size_t>(i)];
    writer.write(room.render(cameras, world_from_body, time));
    if (progress) progress(i + 1, total);
  }
}

}  // namespace byre
