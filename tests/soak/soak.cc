// Runs many simulated missions in one process, each from loading the map to saving the online map, and reports memory,
// descriptors and errors.
// Usage: byre_soak [FRAMES]      300000 by default; a mission has 600
// Exit code: 0 memory and descriptors stay within 5 % after the first tenth, and no pose was trusted and wrong, 1
// otherwise, 2 wrong usage.

#include "byre/place/map_words.h"
#include "byre/slam/places/place_scene.h"
#include "byre/slam/session/session.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string_view>

#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesPerMission = 600;  // at 20 Hz
constexpr int kVisits = 4;              // different visits; later missions repeat them at other times
constexpr double kWrong = 0.2;          // metres
constexpr double kTolerance = 0.05;  // largest relative deviation of memory and descriptors from their settled values

SimulatedMission visit(double laps, int frames, std::uint64_t noise_seed) {
  SimulationOptions options;
  options.noise_seed = noise_seed;
  options.outlier_ratio = 0.05;
  options.max_features = 500;
  return simulate_mission(simulated_rig(), circling_trajectory(frames, 20.0, 2.0, laps), options);
}

// Description of the simulated rig's recording, as stored in a map file.
SourceRecording source() {
  const Rig rig = simulated_rig();
  const Camera camera{CameraModel::pinhole, rig.width, rig.height, rig.focal, rig.focal, rig.cx, rig.cy};
  const Pose right_from_left{Eigen::Quaterniond::Identity(), {-rig.baseline, 0.0, 0.0}};
  return {"simulated", {camera, StereoPartner{camera, right_from_left}, Pose{}}, from_seconds(0.0), from_seconds(30.0)};
}

class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::temp_directory_path() / ("byre_soak." + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  fs::path operator/(std::string_view name) const { return path_ / name; }

 private:
  fs::path path_;
};

// Resource use of the process after a mission.
struct Usage {
  double resident_mb = 0.0;
  int descriptors = 0;
};

Usage usage_now() {
  Usage usage;
  long all_pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> all_pages >> resident_pages;
  usage.resident_mb = 1e-6 * static_cast<double>(resident_pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
  usage.descriptors =
      static_cast<int>(std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
  return usage;
}

struct Tally {
  int frames = 0;
  int with_pose = 0;
  int trusted = 0;
  int wrongly_trusted = 0;  // trusted poses with an error above kWrong
  int mapped = 0;           // keyframes
  int broken_maps = 0;      // saved maps that are invalid when read again

  void add(const Tally& other) {
    frames += other.frames;
    with_pose += other.with_pose;
    trusted += other.trusted;
    wrongly_trusted += other.wrongly_trusted;
    mapped += other.mapped;
    broken_maps += other.broken_maps;
  }
};

// Frame i of a mission: the camera is covered for 20 frames, and later the robot is kidnapped.
const Frame& frame_at(const SimulatedMission& visit, int mission, int i, const Frame& covered) {
  const int start = 100 + 37 * mission % 200;
  if (i >= start && i < start + 20) return covered;
  return visit.frames[static_cast<std::size_t>(i + (i > 400 ? 60 : 0)) % visit.frames.size()];
}

class Soak {
 public:
  Soak() : vocabulary_(vocabulary_of(visit(1.0, 200, 1))) {
    // The first half of a lap is in the offline map; each mission maps the other half.
    StoredMap stored;
    stored.map = true_map(visit(0.5, 150, 2), 5, Origin::offline);
    stored.recordings = {source()};
    add_words(stored, vocabulary_);
    save_map(stored, folder_ / "known.byre");
    for (int i = 0; i < kVisits; ++i) visits_.push_back(visit(2.0, kFramesPerMission, 10 + i));
  }

  Tally run_mission(int mission) const {
    const SimulatedMission& visit = visits_[static_cast<std::size_t>(mission % kVisits)];
    Tally tally;
    Session session = start();
    const Frame covered{{}, std::make_shared<const Features>()};
    for (int i = 0; i < kFramesPerMission; ++i) {
      const Frame& seen = frame_at(visit, mission, i, covered);
      Frame frame = seen;
      frame.time = from_seconds(3600.0 * mission + 0.05 * i);
      evaluate(session.process(frame), visit, seen, tally);
    }
    session.finish();
    session.finish_mission({});
    tally.mapped = session.map().online().keyframe_count();
    if (tally.mapped > 0) tally.broken_maps = is_saved_map_valid(session) ? 0 : 1;
    return tally;
  }

 private:
  Session start() const {
    StoredMap stored = load_map(folder_ / "known.byre");
    return {simulated_rig(),
            {},
            SessionExecutors(make_paced_executor(4), make_paced_executor(20)),
            vocabulary_,
            std::make_shared<const OfflineMap>(std::move(stored.map), vocabulary_)};
  }

  static void evaluate(const FrameReport& report, const SimulatedMission& visit, const Frame& seen, Tally& tally) {
    ++tally.frames;
    if (!report.map_from_body) return;
    ++tally.with_pose;
    if (report.health.verdict != Verdict::trusted) return;
    ++tally.trusted;
    const auto shown = std::ranges::find(visit.frames, seen.features, &Frame::features);
    if (shown == visit.frames.end()) return;
    const Pose& truth = visit.truth[static_cast<std::size_t>(shown - visit.frames.begin())].world_from_body;
    if ((report.map_from_body->translation - truth.translation).norm() > kWrong) ++tally.wrongly_trusted;
  }

  // Saves the online map; returns whether it is valid when read again.
  bool is_saved_map_valid(const Session& session) const {
    StoredMap stored;
    stored.map = offline_copy(session.map().online());
    stored.recordings = {source()};
    add_words(stored, vocabulary_);
    save_map(stored, folder_ / "beside.byre");
    return find_faults(load_map(folder_ / "beside.byre")).empty();
  }

  TemporaryFolder folder_;
  Vocabulary vocabulary_;
  std::vector<SimulatedMission> visits_;
};

// Mean resource use over a tenth of the missions.
struct Tenth {
  double resident_mb = 0.0;
  double descriptors = 0.0;
};

std::vector<Tenth> tenths_of(const std::vector<Usage>& usages) {
  std::vector<Tenth> tenths;
  for (std::size_t part = 0; part < 10; ++part) {
    const std::size_t begin = part * usages.size() / 10, end = (part + 1) * usages.size() / 10;
    Tenth tenth;
    for (std::size_t i = begin; i < end; ++i) {
      tenth.resident_mb += usages[i].resident_mb / static_cast<double>(end - begin);
      tenth.descriptors += static_cast<double>(usages[i].descriptors) / static_cast<double>(end - begin);
    }
    tenths.push_back(tenth);
  }
  return tenths;
}

bool is_near(double value, double settled) {
  return std::abs(value - settled) <= kTolerance * settled;
}

// Memory growth per day at 20 Hz, megabytes: slope of a line through the tenths after the first.
double growth_in_a_day(const std::vector<Tenth>& tenths, int frames) {
  const double middle = 0.5 * static_cast<double>(1 + tenths.size() - 1);
  double product = 0.0, square = 0.0;
  for (std::size_t i = 1; i < tenths.size(); ++i) {
    product += (static_cast<double>(i) - middle) * tenths[i].resident_mb;
    square += (static_cast<double>(i) - middle) * (static_cast<double>(i) - middle);
  }
  constexpr double kFramesOfADay = 86400.0 * 20.0;
  return product / square / (0.1 * frames) * kFramesOfADay;
}

int soak(int frames) {
  const Soak soak;
  const int missions = std::max(10, frames / kFramesPerMission);
  Tally all;
  std::vector<Usage> usages;
  for (int mission = 0; mission < missions; ++mission) {
    all.add(soak.run_mission(mission));
    usages.push_back(usage_now());
    if ((mission + 1) % std::max(1, missions / 10) == 0) {
      std::printf("%7d frames  %6.1f MB  %d descriptors\n", all.frames, usages.back().resident_mb,
                  usages.back().descriptors);
      std::fflush(stdout);
    }
  }
  const std::vector<Tenth> tenths = tenths_of(usages);
  // The heap reaches its size during the first tenth.
  const Tenth& settled = tenths[1];
  const bool is_flat = std::all_of(tenths.begin() + 2, tenths.end(), [&](const Tenth& tenth) {
    return is_near(tenth.resident_mb, settled.resident_mb) && is_near(tenth.descriptors, settled.descriptors);
  });
  std::printf("\n%d missions, %d frames: %.1f %% with a pose, %.1f %% trusted, %d trusted with errors above %.1f m\n",
              missions, all.frames, 1e2 * all.with_pose / all.frames, 1e2 * all.trusted / all.frames,
              all.wrongly_trusted, kWrong);
  std::printf("%d keyframes were added online; %d kept maps are invalid\n", all.mapped, all.broken_maps);
  std::printf("memory by tenths, MB:");
  for (const Tenth& tenth : tenths) std::printf(" %.1f", tenth.resident_mb);
  std::printf("\na day of 20 frames a second would add %.1f MB; memory and descriptors %s within 5 %%\n",
              growth_in_a_day(tenths, all.frames), is_flat ? "stay" : "DO NOT stay");
  return is_flat && all.wrongly_trusted == 0 && all.broken_maps == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace byre

int main(int argc, char** argv) {
  int frames = 300000;
  const std::string_view text = argc > 1 ? argv[1] : "300000";
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frames);
  if (argc > 2 || error != std::errc() || end != text.data() + text.size() || frames < 1) {
    std::fprintf(stderr, "usage: byre_soak [FRAMES]\n");
    return 2;
  }
  return byre::soak(frames);
}
