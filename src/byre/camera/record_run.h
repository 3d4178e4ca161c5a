#pragma once

#include "byre/camera/capture_thread.h"
#include "byre/camera/frame_sink.h"

#include <functional>
#include <optional>
#include <string>

namespace byre {

// When to stop; whichever comes first.
struct RecordLimits {
  std::optional<double> duration_s{};  // from the first frame on
  std::optional<int> frames{};
};

struct RecordHooks {
  std::function<bool()> should_stop;  // asked all the time; frames that came before are still written
  std::function<void(int frames, const ImageFrame& newest)> after_frame;
  std::function<void(const std::string& note)> tell;  // what befell the cameras, at once
};

struct RecordedFrames {
  int frames = 0;
  int with_right = 0;
  int passed_over = 0;  // frames that came faster than they could be written, for so long that they no longer fit
  std::optional<Timestamp> first{}, last{};
  LiveCameraReport cameras;
};

// Hands all that comes to a sink, until it is to stop. Throws InputError as the sink and the cameras do.
RecordedFrames record_frames(CaptureThread& capture, FrameSink& sink, const RecordLimits& limits,
                             const RecordHooks& hooks);

}  // namespace byre
