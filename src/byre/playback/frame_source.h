#pragma once

#include "byre/playback/decode_ahead.h"
#include "byre/playback/live_clock.h"
#include "byre/playback/map_run.h"

#include <functional>
#include <optional>

namespace byre {

// Where the frames of a run come from, one after the other.
class FrameSource {
 public:
  struct SourceFrame {
    DecodedFrame decoded;
    double late_s = 0.0;  // seconds by which it comes too late, where frames are fed at their own time stamps
  };

  virtual ~FrameSource() = default;
  virtual const Calibration& calibration() const = 0;
  // What wheels and a gyroscope tell beside the frames; live cameras come without.
  virtual const MotionSamples& motion() const;
  // Waits for the next frame; empty after the last one, and where nothing comes before should_stop() holds.
  virtual std::optional<SourceFrame> next(const std::function<bool()>& should_stop) = 0;
};

// The frames of a recording, as fast as they are asked for, or at their own time stamps.
class PlayedRecording final : public FrameSource {
 public:
  // The recording must outlive it, and nobody else may read from it meanwhile.
  PlayedRecording(Recording& recording, bool is_live) : recording_(recording), decoder_(recording), is_live_(is_live) {}

  const Calibration& calibration() const override { return recording_.calibration(); }
  const MotionSamples& motion() const override { return recording_.motion(); }
  std::optional<SourceFrame> next(const std::function<bool()>& should_stop) override;

 private:
  const Recording& recording_;
  DecodeAhead decoder_;
  LiveClock clock_;
  const bool is_live_;
};

// As run_map of map_run.h, which plays a recording: maps all frames that come, until there are no more.
MapRun run_map(FrameSource& frames, const EngineOptions& options, const MapRunHooks& hooks,
               std::optional<Map> before = {});

}  // namespace byre
