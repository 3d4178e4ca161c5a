// Scaling of byre with map size: a saved map is tiled to sites of given numbers of keyframes, and a recording of that
// map runs on each. --write saves a site, for extension or adjustment by the program.

#include "connected_site.h"
#include "tiled_map.h"

#include "byre/base/stopwatch.h"
#include "byre/benchmark/markdown_table.h"
#include "byre/benchmark/speed.h"
#include "byre/features/image_threads.h"
#include "byre/geometry/evaluation/distribution.h"
#include "byre/input_error.h"
#include "byre/recording.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/system/resources.h"
#include "byre/slam/system/slam_impl.h"
#include "byre/slam/system/stored_map.h"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr double kMegabyte = 1e6;
constexpr double kMilliseconds = 1e3;
constexpr double kMicroseconds = 1e6;

// CPU time of the calling thread, independent of the machine's load.
class ThreadStopwatch {
 public:
  double seconds() const { return now() - begin_; }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  double begin_ = now();
};

struct Writing {
  double seconds = 0.0;
  double file_mb = 0.0;
  int points = 0;
};

struct Opening {
  double seconds = 0.0;            // wall time, best of three
  double cpu_seconds = 0.0;        // CPU time of all threads, least of three
  double first_cpu_seconds = 0.0;  // CPU time of the first opening, before the program has heap memory to reuse
  double resident_mb = 0.0;        // increase of the program's resident memory
};

struct Use {
  double index_seconds = 0.0;  // CPU time of all threads
  double index_mb = 0.0;
  Distribution query_ms;
  Distribution localise_ms;
  int localised = 0;
  Distribution frame_ms;      // wall time
  Distribution frame_cpu_ms;  // CPU time of the frame thread
  int with_pose = 0;
  double ground_seconds = 0.0;
  double stand_us = 0.0;
};

struct Inputs {
  fs::path map;
  fs::path recording;
  Vocabulary vocabulary;
};

double heap_mb() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / kMegabyte;
}

fs::path site_file() {
  return fs::temp_directory_path() / fmt::format("byre_site_{}.byre", static_cast<int>(getpid()));
}

// Runs a measurement in a child process, so that memory left by one does not count in the next.
template <typename Result>
Result in_child(const std::function<Result()>& measure) {
  static_assert(std::is_trivially_copyable_v<Result>);
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("there is no pipe to be had");
  const pid_t child = fork();
  if (child == 0) {
    try {
      const Result result = measure();
      const bool is_told = write(ends[1], &result, sizeof(result)) == ssize_t{sizeof(result)};
      std::_Exit(is_told ? EXIT_SUCCESS : EXIT_FAILURE);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "byre_site: %s\n", error.what());
      std::_Exit(EXIT_FAILURE);
    }
  }
  close(ends[1]);
  Result result;
  const bool is_whole = child > 0 && read(ends[0], &result, sizeof(result)) == ssize_t{sizeof(result)};
  close(ends[0]);
  if (child > 0) waitpid(child, nullptr, 0);
  if (!is_whole) throw std::runtime_error("a measurement failed");
  return result;
}

Writing write_site(const Inputs& inputs, int keyframes, const fs::path& file) {
  const StoredMap site = tiled_map(load_for_mapping(inputs.map, inputs.vocabulary), keyframes, inputs.vocabulary);
  const Stopwatch watch;
  save_map(site, file);
  return {watch.seconds(), static_cast<double>(fs::file_size(file)) / kMegabyte, site.map.point_count()};
}

// The file is in the page cache.
Opening open_site(const Inputs& inputs, const fs::path& file) {
  constexpr int kTimes = 3;
  Opening best;
  for (int i = 0; i < kTimes; ++i) {
    const double memory_before = resident_memory_mb();
    const double cpu_before = resource_usage().cpu_seconds;
    const Stopwatch watch;
    const auto offline = load_offline_map(file, inputs.vocabulary);
    const double seconds = watch.seconds(), cpu_seconds = resource_usage().cpu_seconds - cpu_before;
    if (i == 0) best = {seconds, cpu_seconds, cpu_seconds, resident_memory_mb() - memory_before};
    best.seconds = std::min(best.seconds, seconds);
    best.cpu_seconds = std::min(best.cpu_seconds, cpu_seconds);
  }
  return best;
}

void measure_index(const Inputs& inputs, const OfflineMap& offline, Use& use) {
  const double heap_before = heap_mb();
  const double cpu_before = resource_usage().cpu_seconds;
  const PlaceIndex index = index_of(offline.map(), inputs.vocabulary);
  use.index_seconds = resource_usage().cpu_seconds - cpu_before;
  use.index_mb = heap_mb() - heap_before;
}

Calibration calibration_of(const OfflineMap& offline, const Recording& recording) {
  const auto known = stored_calibration(offline.recordings(), recording.calibration());
  return known ? known->calibration : recording.calibration();
}

// Localises every tenth frame of the recording without a prior.
void measure_places(const OfflineMap& offline, Recording& recording, Use& use) {
  constexpr int kStride = 10;
  Extractor extractor(calibration_of(offline, recording), {});
  const MapGraph nothing_online(Origin::online);
  const MapView view(&offline.map(), nothing_online);
  std::vector<double> queries, searches;
  for (int i = 0; i < recording.size(); i += kStride) {
    const std::optional<ImageFrame> images = recording.read(i);
    if (!images) continue;
    const Frame frame = extractor.extract(*images).frame;
    const std::vector<Word> words = offline.places().vocabulary().words_of(*frame.features);
    const ThreadStopwatch query;
    find_places(offline.places(), view, words, {});
    queries.push_back(kMilliseconds * query.seconds());
    const ThreadStopwatch search;
    if (localise(frame, extractor.rig(), view, offline.places(), {}).tracked) ++use.localised;
    searches.push_back(kMilliseconds * search.seconds());
  }
  use.query_ms = distribution_of(queries);
  use.localise_ms = distribution_of(searches);
}

// Runs the recording as a mission.
void measure_frames(const Inputs& inputs, const std::shared_ptr<const OfflineMap>& offline, Recording& recording,
                    Use& use) {
  MethodOptions options;
  options.extract.threads = 1;
  SlamImpl slam(recording.calibration(), options, {.vocabulary = inputs.vocabulary, .offline = offline});
  std::vector<double> wall, cpu;
  for (int i = 0; i < recording.size(); ++i) {
    const std::optional<ImageFrame> images = recording.read(i);
    if (!images) continue;
    const ThreadStopwatch watch;
    const FrameReport report = slam.process(*images);
    cpu.push_back(kMilliseconds * watch.seconds());
    wall.push_back(kMilliseconds * slam.seconds().total);
    if (report.map_from_body) ++use.with_pose;
  }
  slam.finish({[] { return true; }, {}});
  use.frame_ms = distribution_of(wall);
  use.frame_cpu_ms = distribution_of(cpu);
}

// Uses a synthetic driven map, because the recording need not have a ground plane.
void measure_ground(int keyframes, Use& use) {
  constexpr int kStands = 1000;
  const MapGraph field = driven_field(keyframes);
  const ThreadStopwatch watch;
  const std::optional<DrivenGround> ground = DrivenGround::under(field);
  use.ground_seconds = watch.seconds();
  if (!ground) return;
  const ThreadStopwatch stands;
  for (int i = 0; i < kStands; ++i)
    ground->offset_from_ground({Eigen::Quaterniond::Identity(), {0.05 * i, 0.03 * i, 0.0}});
  use.stand_us = kMicroseconds * stands.seconds() / kStands;
}

Use use_site(const Inputs& inputs, int keyframes, const fs::path& file) {
  Use use;
  const auto offline = load_offline_map(file, inputs.vocabulary);
  const auto recording = open_recording(inputs.recording, {});
  measure_index(inputs, *offline, use);
  measure_places(*offline, *recording, use);
  measure_frames(inputs, offline, *recording, use);
  measure_ground(keyframes, use);
  return use;
}

// Increase of resident memory by opening the map and running the mission, including the mission's own data.
double memory_of_mission(const Inputs& inputs, const fs::path& file) {
  const double before = resident_memory_mb();
  const auto offline = load_offline_map(file, inputs.vocabulary);
  const auto recording = open_recording(inputs.recording, {});
  Use use;
  measure_frames(inputs, offline, *recording, use);
  return resident_memory_mb() - before;
}

std::vector<std::string> cells_of(int keyframes, const Writing& writing, const Opening& opening, const Use& use,
                                  double mission_mb) {
  return {std::to_string(keyframes),
          std::to_string(writing.points),
          fmt::format("{:.1f}", writing.file_mb),
          fmt::format("{:.2f}", writing.seconds),
          fmt::format("{:.2f} ({:.2f}, first {:.2f})", opening.seconds, opening.cpu_seconds, opening.first_cpu_seconds),
          fmt::format("{:.0f}", opening.resident_mb),
          fmt::format("{:.3f}, {:.1f} MB", use.index_seconds, use.index_mb),
          fmt::format("{:.2f} ({:.2f})", use.query_ms.mean, use.query_ms.max),
          fmt::format("{:.1f} ({:.1f})", use.localise_ms.mean, use.localise_ms.max),
          fmt::format("{} of {}", use.localised, use.localise_ms.count),
          fmt::format("{:.1f} ({:.1f})", use.frame_ms.mean, use.frame_ms.p99),
          fmt::format("{:.1f} ({:.1f})", use.frame_cpu_ms.mean, use.frame_cpu_ms.p99),
          fmt::format("{:.0f}", mission_mb),
          fmt::format("{} of {}", use.with_pose, use.frame_ms.count),
          fmt::format("{:.3f}, {:.1f} us", use.ground_seconds, use.stand_us)};
}

void measure(const Inputs& inputs, const std::vector<int>& sizes) {
  MarkdownTable table({"keyframes", "points", "file, MB", "written, s", "opened, s (CPU)", "resident, MB", "index, s",
                       "place query, ms (max)", "from nothing, ms (max)", "found", "frame, ms (p99)",
                       "frame's CPU, ms (p99)", "resident after it, MB", "poses", "ground, s; a stand"});
  const fs::path file = site_file();
  for (const int keyframes : sizes) {
    const auto writing = in_child<Writing>([&] { return write_site(inputs, keyframes, file); });
    const auto opening = in_child<Opening>([&] { return open_site(inputs, file); });
    const auto use = in_child<Use>([&] { return use_site(inputs, keyframes, file); });
    const auto mission_mb = in_child<double>([&] { return memory_of_mission(inputs, file); });
    fs::remove(file);
    table.add(cells_of(keyframes, writing, opening, use, mission_mb));
  }
  std::fputs(table.text().c_str(), stdout);
}

int size_in(const char* argument) {
  int size = 0;
  const auto [end, fault] = std::from_chars(argument, argument + std::strlen(argument), size);
  if (fault != std::errc() || *end != '\0' || size < 1) {
    throw InputError(argument, "is no number of keyframes", "name one or more, such as 100 1000 10000");
  }
  return size;
}

std::vector<int> sizes_in(int argc, char** argv, int first) {
  std::vector<int> sizes;
  for (int i = first; i < argc; ++i) sizes.push_back(size_in(argv[i]));
  return sizes.empty() ? std::vector<int>{100, 1000, 10000} : sizes;
}

// Adjusts sites with crossing lanes, with a hundred points per pose, up to the size of a whole map.
void adjust_sites(const std::vector<int>& sizes) {
  constexpr int kPointsOfPose = 100;
  MarkdownTable table({"poses", "points", "observations", "iterations", "wall, s", "CPU, s", "position error, mm",
                       "of it before, MB", "at most, MB"});
  for (const int poses : sizes) {
    const ConnectedSite site(poses, kPointsOfPose * poses);
    BundleOptions options;
    options.max_iterations = 14;
    reset_peak_memory();
    const double before = resident_memory_mb(), cpu_before = resource_usage().cpu_seconds;
    const Stopwatch watch;
    const BundleResult result = bundle_adjust(site.problem(), options);
    const double seconds = watch.seconds(), cpu_seconds = resource_usage().cpu_seconds - cpu_before;
    table.add({std::to_string(poses), std::to_string(site.problem().points.size()),
               std::to_string(site.problem().observations.size()), std::to_string(result.iterations),
               fmt::format("{:.1f}", seconds), fmt::format("{:.1f}", cpu_seconds),
               fmt::format("{:.2f}", 1e3 * site.position_error(result.camera_from_world)),
               fmt::format("{:.0f}", before), fmt::format("{:.0f}", peak_memory_mb().value_or(0.0))});
  }
  std::fputs(table.text().c_str(), stdout);
}

void run(int argc, char** argv) {
  limit_image_threads(1);
  if (std::strcmp(argv[1], "--adjust") == 0) return adjust_sites(sizes_in(argc, argv, 2));
  const bool only_writes = std::strcmp(argv[1], "--write") == 0;
  if (only_writes && argc != 5) throw InputError("--write", "needs a map, its keyframes and a file", "name all three");
  if (only_writes) {
    write_site({argv[2], {}, open_vocabulary({})}, size_in(argv[3]), argv[4]);
  } else {
    measure({argv[1], argv[2], open_vocabulary({})}, sizes_in(argc, argv, 3));
  }
}

}  // namespace
}  // namespace byre

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs(
        "usage: byre_site MAP RECORDING [KEYFRAMES...]\n       byre_site --write MAP KEYFRAMES SITE\n"
        "       byre_site --adjust KEYFRAMES...\n",
        stderr);
    return 2;
  }
  try {
    byre::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "byre_site: %s\n", error.what());
    return 1;
  }
  return 0;
}
