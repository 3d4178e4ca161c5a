#pragma once

#include "byre/base/stopwatch.h"
#include "byre/camera/capture_thread.h"
#include "byre/playback/frame_source.h"

#include <functional>
#include <optional>
#include <string>

namespace byre {

// Frames of live cameras for a run; a slow consumer gets the newest frame next.
class LiveFrames final : public FrameSource {
 public:
  // duration_s: from the first frame on; empty: unlimited. on_note: receives events of the cameras immediately. Throws
  // InputError like CaptureThread, and if the calibration of that file does not match the cameras.
  LiveFrames(LiveCameraOptions options, const Calibration& calibration, const std::string& calibration_file,
             std::optional<double> duration_s, std::function<void(const std::string& note)> on_note);

  const Calibration& calibration() const override { return calibration_; }
  std::optional<SourceFrame> next(const std::function<bool()>& should_stop) override;

  int skipped() const { return capture_.skipped(); }
  // Stops the cameras, and returns their statistics.
  LiveCameraReport finish();

 private:
  bool is_over() const;
  void report_notes();

  const Calibration calibration_;
  const std::optional<double> duration_s_;
  const std::function<void(const std::string& note)> on_note_;
  CaptureThread capture_;
  std::optional<Stopwatch> since_first_;
  std::optional<Timestamp> first_, last_;
};

}  // namespace byre
