#include "byre/playback/scaled_recording.h"

#include <utility>

namespace byre {
namespace {

// Same frames with the camera as the body.
class OfCamera final : public Recording {
 public:
  explicit OfCamera(std::unique_ptr<Recording> recording)
      : recording_(std::move(recording)), calibration_(recording_->calibration()) {
    calibration_.body_from_left = {};
  }

  const Calibration& calibration() const override { return calibration_; }
  const std::vector<Timestamp>& times() const override { return recording_->times(); }
  std::optional<ImageFrame> read(int index) override { return recording_->read(index); }
  const MotionSamples& motion() const override { return recording_->motion(); }
  const TimeCorrections& time_corrections() const override { return recording_->time_corrections(); }
  const std::vector<std::string>& warnings() const override { return recording_->warnings(); }

 private:
  std::unique_ptr<Recording> recording_;
  Calibration calibration_;
};

}  // namespace

std::string source_name(const std::filesystem::path& recording) {
  return std::filesystem::weakly_canonical(recording).filename().string();
}

Trajectory ScaledRecording::path_of(const Trajectory& world_from_body) const {
  Trajectory path = world_from_body;
  for (StampedPose& sample : path) sample.world_from_body = sample.world_from_body * body_from_camera;
  return path;
}

ScaledRecording open_scaled(const std::filesystem::path& path, const FrameRange& range, const OpenOptions& options,
                            bool has_metric_map) {
  ScaledRecording opened;
  opened.recording = open_recording(path, range, options);
  if (has_metric_map || opened.recording->calibration().is_metric()) return opened;
  opened.is_metric = false;
  opened.body_from_camera = opened.recording->calibration().body_from_left;
  opened.recording = std::make_unique<OfCamera>(std::move(opened.recording));
  return opened;
}

}  // namespace byre
