// A mission on a saved map: prints events, and each change in the trust of the pose.
//
//   03_mission_on_a_map RECORDING MAP

#include "byre/byre.h"

#include <cstdio>
#include <optional>
#include <string>

namespace {

class Log {
 public:
  void note(const byre::FrameReport& report) {
    for (const byre::SessionEvent event : report.events) say(report, std::string(byre::to_string(event)));
    if (report.correction) {
      say(report, "the map was corrected, and moved the robot by " +
                      std::to_string(report.correction->translation.norm()) + " m");
    }
    const byre::Health& health = report.health;
    if (verdict_ != health.verdict) {
      verdict_ = health.verdict;
      const bool is_doubted = health.doubt != byre::DistrustReason::none;
      say(report, std::string(byre::to_string(health.verdict)) +
                      (is_doubted ? ": " + std::string(byre::to_string(health.doubt)) : ""));
    }
    if (health.verdict == byre::Verdict::trusted) ++trusted_;
  }
  int trusted() const { return trusted_; }

 private:
  static void say(const byre::FrameReport& report, const std::string& what) {
    std::printf("%.3f s  %s\n", byre::to_seconds(report.time), what.c_str());
  }

  std::optional<byre::Verdict> verdict_;  // verdict of the previous frame
  int trusted_ = 0;                       // number of trusted frames
};

void run(const char* path, const char* map_path) {
  const auto recording = byre::open_recording(path, {});
  byre::SlamOptions options;
  options.workers = byre::Workers::repeatable;
  byre::Slam slam = byre::Slam::on_map(recording->calibration(), map_path, options);
  Log log;
  for (int i = 0; i < recording->size(); ++i) {
    if (const auto frame = recording->read(i)) log.note(slam.process(view_of(*frame)));
  }
  slam.finish();
  std::printf("%d of %d frames trusted\n", log.trusted(), slam.frames());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: 03_mission_on_a_map RECORDING MAP\n");
    return 2;
  }
  try {
    run(argv[1], argv[2]);
  } catch (const byre::InputError& error) {
    std::fprintf(stderr, "03_mission_on_a_map: %s\n", error.what());
    return 3;
  }
  return 0;
}
