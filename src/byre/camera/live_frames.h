#pragma once

#include "byre/camera/capture_thread.h"
#include "byre/playback/frame_source.h"
#include "byre/workers/stopwatch.h"

#include <functional>
#include <optional>
#include <string>

namespace byre {

// The frames of live cameras for a run: whoever is slow gets the newest one next.
class LiveFrames final : public FrameSource {
 public:
  // duration_s: from the first frame on; empty: without end. tell: called with what befalls the cameras, at once.
  // Throws InputError as CaptureThread does, and where the calibration, of that file, is not of such cameras.
  LiveFrames(LiveCameraOptions options, const Calibration& calibration, const std::string& calibration_file,
             std::optional<double> duration_s, std::function<void(const std::string& note)> tell);

  const Calibration& calibration() const override { return calibration_; }
  std::optional<SourceFrame> next(const std::function<bool()>& should_stop) override;

  int passed_over() const { return capture_.passed_over(); }
  // Ends the cameras, and tells what came of them.
  LiveCameraReport finish();

 private:
  bool is_over() const;
  void tell_notes();

  const Calibration calibration_;
  const std::optional<double> duration_s_;
  const std::function<void(const std::string& note)> tell_;
  CaptureThread capture_;
  std::optional<Stopwatch> since_first_;
  std::optional<Timestamp> first_, last_;
};

}  // namespace byre
