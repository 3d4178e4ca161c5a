#pragma once

#include "byre/input_error.h"
#include "byre/recording.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/slam.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace byre {

// A rendered recording of a room, common to tests.
inline std::unique_ptr<Recording> open_shared() {
  return open_recording(RenderedFixture::shared().folder(), {});
}

inline std::vector<ImageFrame> shared_frames() {
  const auto recording = open_shared();
  std::vector<ImageFrame> frames;
  for (int i = 0; i < recording->size(); ++i) frames.push_back(recording->read(i).value());
  return frames;
}

inline SlamOptions repeatable() {
  SlamOptions options;
  options.workers = Workers::repeatable;
  return options;
}

// Published poses.
inline Trajectory causal(Slam& slam, const std::vector<ImageFrame>& frames) {
  Trajectory poses;
  for (const ImageFrame& frame : frames) {
    const FrameReport report = slam.process(view_of(frame));
    if (report.map_from_body) poses.push_back({report.time, *report.map_from_body});
  }
  return poses;
}

// Message of the InputError; empty without one.
inline std::string error_by(const std::function<void()>& attempt) {
  try {
    attempt();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace byre
