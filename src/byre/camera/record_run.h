#pragma once

#include "byre/camera/capture_thread.h"
#include "byre/camera/frame_sink.h"

#include <functional>
#include <optional>
#include <string>

namespace byre {

// Limits of a recording; the first one reached ends it.
struct RecordLimits {
  std::optional<double> duration_s{};  // from the first frame on
  std::optional<int> frames{};
};

struct RecordHooks {
  std::function<bool()> should_stop;  // polled continuously; earlier frames are still written
  std::function<void(int frames, const ImageFrame& newest)> after_frame;
  std::function<void(const std::string& note)> on_note;  // receives events of the cameras immediately
};

struct RecordedFrames {
  int frames = 0;
  int with_right = 0;
  int skipped = 0;  // frames dropped because writing was too slow and the queue was full
  std::optional<Timestamp> first{}, last{};
  LiveCameraReport cameras;
};

// Writes all frames to a sink until a limit is reached. Throws InputError like the sink and the cameras.
RecordedFrames record_frames(CaptureThread& capture, FrameSink& sink, const RecordLimits& limits,
                             const RecordHooks& hooks);

}  // namespace byre
