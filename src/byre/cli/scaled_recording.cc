#include "byre/cli/scaled_recording.h"

#include "byre/map/scaled_copy.h"

#include <utility>

namespace byre::cli {
namespace {

// The same frames, of cameras that are taken for others.
class Recalibrated final : public Recording {
 public:
  Recalibrated(std::unique_ptr<Recording> recording, Calibration calibration)
      : recording_(std::move(recording)), calibration_(std::move(calibration)) {}

  const Calibration& calibration() const override { return calibration_; }
  const std::vector<Timestamp>& times() const override { return recording_->times(); }
  std::optional<ImageFrame> read(int index) override { return recording_->read(index); }
  const std::vector<std::string>& warnings() const override { return recording_->warnings(); }

 private:
  std::unique_ptr<Recording> recording_;
  Calibration calibration_;
};

// With the camera for the body.
std::unique_ptr<Recording> of_camera(std::unique_ptr<Recording> recording) {
  Calibration calibration = recording->calibration();
  calibration.body_from_left = {};
  return std::make_unique<Recalibrated>(std::move(recording), calibration);
}

}  // namespace

Trajectory ScaledRecording::path_of(const Trajectory& world_from_body) const {
  Trajectory path = world_from_body;
  for (StampedPose& sample : path) sample.world_from_body = sample.world_from_body * body_from_camera;
  return path;
}

std::unique_ptr<Recording> on_map(std::unique_ptr<Recording> recording, const StoredMap& stored) {
  const Calibration calibration = calibration_on(stored, recording->calibration());
  return std::make_unique<Recalibrated>(std::move(recording), calibration);
}

ScaledRecording open_scaled(const std::filesystem::path& path, const FrameRange& range, const OpenOptions& options,
                            bool has_metric_map) {
  ScaledRecording opened;
  opened.recording = open_recording(path, range, options);
  if (has_metric_map || opened.recording->calibration().right) return opened;
  opened.is_metric = false;
  opened.body_from_camera = opened.recording->calibration().body_from_left;
  opened.recording = of_camera(std::move(opened.recording));
  return opened;
}

}  // namespace byre::cli
