#pragma once

#include "byre/cli/shared/options.h"
#include "byre/playback/frame_source.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace byre::cli {

struct CameraOptions;

// --live with its options: cameras instead of a recording.
struct LiveOptions {
  std::shared_ptr<CameraOptions> cameras;  // null unless declared
  std::optional<double> duration_s;

  bool is_wanted() const;
  std::string name() const;  // names of the devices
};

// Declares --live, --duration and the options of cameras, which are played at live pace unless --pace is given.
// Options of recordings, declared before, exclude them. The options must outlive the parsing of the command line.
void declare_live_options(CLI::App& command, LiveOptions& options, MethodArguments& arguments);

struct LiveInput {
  std::unique_ptr<FrameSource> frames;
  std::function<std::string()> report;  // stops the cameras, and returns report rows; call it once
};

// Throws InputError like LiveFrames.
LiveInput open_live(const LiveOptions& options, const Calibration& calibration, const std::string& calibration_file,
                    std::function<void(const std::string& note)> on_note);

}  // namespace byre::cli
