// Stops "byre map" and "byre run" at random times; all outputs must be complete. BYRE_STOPS=1000 sets the number of
// stops.

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/trajectory_file.h"

#include <array>
#include <map>
#include <random>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

int wanted_stops() {
  const char* const wanted = std::getenv("BYRE_STOPS");
  return wanted == nullptr ? 8 : std::atoi(wanted);
}

unsigned wanted_seed() {
  const char* const wanted = std::getenv("BYRE_STOPS_SEED");
  return wanted == nullptr ? 1u : static_cast<unsigned>(std::atoi(wanted));
}

// Exit status of a stopped process.
struct End {
  int signal = 0;  // signal that killed it, or 0
  int code = -1;   // exit code, or -1 if killed
};

class Stops : public ProgramTest {
 protected:
  enum class Moment { any, saving };

  std::vector<std::string> map_arguments() const {
    return {"map",
            recording_.folder().string(),
            "--pace",
            "live",
            "--autosave",
            "0.1",
            "-o",
            path("room.byre"),
            "--trajectory",
            path("final.txt"),
            "--causal-trajectory",
            path("causal.txt"),
            "--stats",
            path("stats.json")};
  }

  std::vector<std::string> run_arguments() const {
    return {"run",
            recording_.folder().string(),
            "--pace",
            "live",
            "--save-online",
            path("room.byre"),
            "--events",
            path("events.jsonl"),
            "--trajectory",
            path("final.txt"),
            "--causal-trajectory",
            path("causal.txt"),
            "--stats",
            path("stats.json")};
  }

  void clear() const {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) fs::remove_all(entry);
  }

  double seconds_of_whole_run() const {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(exit_code_of(start(map_arguments())), 0) << read("stderr.txt");
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  static bool has_ended(pid_t process) {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == process;
  }

  void wait_for(Moment moment, double seconds, pid_t process) const {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    while (moment == Moment::saving && !has_ended(process) && !has_unfinished_files()) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }

  static End end_of(pid_t process) {
    int status = 0;
    EXPECT_EQ(waitpid(process, &status, 0), process);
    return WIFSIGNALED(status) ? End{WTERMSIG(status), -1} : End{0, WEXITSTATUS(status)};
  }

  bool is_there(const char* name) const { return fs::exists(folder_ / name); }

  void expect_sound_map() const {
    try {
      EXPECT_THAT(find_faults(load_map(folder_ / "room.byre")), IsEmpty());
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
  }

  // Time of the saved map; the earliest time without one.
  fs::file_time_type time_saved() const {
    return is_there("room.byre") ? fs::last_write_time(folder_ / "room.byre") : fs::file_time_type::min();
  }

  // Expects that all existing files are complete.
  void expect_whole_files() const {
    if (is_there("room.byre")) expect_sound_map();
    for (const char* const name : {"final.txt", "causal.txt"}) {
      const std::string text = is_there(name) ? read(name) : "\n";
      EXPECT_TRUE(text.ends_with('\n')) << name;
    }
    EXPECT_TRUE(!is_there("stats.json") || nlohmann::json::accept(read("stats.json")));
  }

  // Expects all outputs of a run with at least one frame.
  void expect_everything() const {
    for (const char* const name : {"final.txt", "causal.txt", "stats.json"}) EXPECT_TRUE(is_there(name)) << name;
    const bool has_poses = read("causal.txt").find('\n') + 1 < read("causal.txt").size();
    EXPECT_TRUE(is_there("room.byre") || !has_poses);
    EXPECT_FALSE(has_unfinished_files());
  }

  void expect_nothing() const {
    for (const char* const name : {"room.byre", "final.txt", "causal.txt", "stats.json"}) {
      EXPECT_FALSE(is_there(name)) << name;
    }
  }

  std::string path(const char* name) const { return (folder_ / name).string(); }

  const RenderedFixture recording_{"byre_stopped_room", 16, 20.0};
};

TEST_F(Stops, AtRandomTimesLeaveCompleteFiles) {
  constexpr std::array kStops = {SIGINT, SIGTERM, SIGHUP, SIGKILL};
  std::mt19937 random(wanted_seed());
  const double whole_s = seconds_of_whole_run();
  std::map<std::string, int> counts;
  for (int i = 0; i < wanted_stops(); ++i) {
    clear();
    const int signal = kStops[static_cast<std::size_t>(i) % kStops.size()];
    const Moment moment = i % 3 == 2 ? Moment::saving : Moment::any;
    const bool is_map = (i / 4) % 2 == 0;
    const double delay_s = std::uniform_real_distribution(0.0, (moment == Moment::any ? 1.0 : 0.7) * whole_s)(random);
    SCOPED_TRACE("stop " + std::to_string(i) + ", signal " + std::to_string(signal) + " after " +
                 std::to_string(delay_s) + " s");
    const pid_t process = start(is_map ? map_arguments() : run_arguments());
    ASSERT_GT(process, 0);
    wait_for(moment, delay_s, process);
    const fs::file_time_type last_saved = time_saved();
    kill(process, signal);
    const End end = end_of(process);
    expect_whole_files();
    EXPECT_GE(time_saved(), last_saved) << "the last map saved is lost";
    const bool is_whole_run = end.code == 0;
    const bool is_stopped = end.code == 128 + signal;
    EXPECT_TRUE(is_whole_run || is_stopped || end.signal == signal) << read("stderr.txt");
    if (is_whole_run || is_stopped) expect_everything();
    // Before the handler is installed and after the run the process just ends.
    if (end.signal == signal && signal != SIGKILL) {
      is_there("stats.json") ? expect_everything() : expect_nothing();
    }
    const std::string kind = is_whole_run            ? "whole"
                             : is_stopped            ? "stopped"
                             : is_there("room.byre") ? "with map"
                                                     : "without";
    ++counts["signal " + std::to_string(signal) + " " + kind];
    if (HasFailure()) break;
  }
  for (const auto& [kind, count] : counts) std::printf("%s: %d\n", kind.c_str(), count);
}

}  // namespace
}  // namespace byre::cli
