// Measures frame times while corrections of the whole map run in parallel: frames come every 50 ms, and every loop
// found corrects the whole map, however small its drift.
// Usage: byre_correction_pace RECORDING
// Prints each correction with the frames during it and the slowest of them. Exit code 2: wrong usage.

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/place/vocabulary.h"
#include "byre/recording.h"
#include "byre/slam/session/session.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

namespace byre {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void run(const char* folder) {
  limit_image_threads(1);
  const auto recording = open_recording(folder, {});
  Extractor extractor(recording->calibration(), {});
  SessionOptions options;
  options.max_drift_to_fuse = 0.0;
  Session session(extractor.rig(), options, SessionExecutors(make_live_executor(), make_live_executor()),
                  Vocabulary::load(default_vocabulary_path()));
  double copy_ms = 0.0, slowest_ms = 0.0;  // times of the frame that began the correction, and of the slowest since
  int frames = -1;                         // frames since the correction began; -1: no correction
  const Clock::time_point begin = Clock::now();
  for (int i = 0; i < recording->size(); ++i) {
    const auto images = recording->read(i);
    std::this_thread::sleep_until(begin + std::chrono::milliseconds(50) * i);
    if (!images) continue;
    const Clock::time_point start = Clock::now();
    const FrameReport report = session.process(extractor.extract(*images).frame);
    const double elapsed_ms = milliseconds_since(start);
    if (frames >= 0) {
      ++frames;
      slowest_ms = std::max(slowest_ms, elapsed_ms);
    }
    if (report.has(SessionEvent::map_corrected)) {
      std::printf(
          "frame %d: %d keyframes corrected, %d frames meanwhile, slowest %.1f ms, the triggering frame %.1f ms\n", i,
          session.map().online().keyframe_count(), frames, slowest_ms, copy_ms);
      std::fflush(stdout);
      frames = -1;
    }
    if (report.has(SessionEvent::loop_found)) {
      copy_ms = elapsed_ms;
      slowest_ms = 0.0;
      frames = 0;
    }
  }
  session.finish_early();
  session.finish();
}

}  // namespace
}  // namespace byre

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: byre_correction_pace RECORDING\n");
    return 2;
  }
  byre::run(argv[1]);
}
