#include "mapped_recording.h"

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/place/vocabulary.h"
#include "byre/trajectory_file.h"

#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

fs::path data_folder() {
  const char* const named = std::getenv("BYRE_DATA");
  return named != nullptr ? fs::path(named) : fs::path(BYRE_SOURCE_DIR).parent_path() / "shared" / "data";
}

}  // namespace

MappedRecording map_recording(const fs::path& folder, const FrameRange& range, std::unique_ptr<Executor> executor,
                              const OpenOptions& options) {
  limit_image_threads(1);
  const std::unique_ptr<Recording> recording = open_recording(folder, range, options);
  Extractor extractor(recording->calibration(), {});
  Session session(extractor.rig(), {}, std::move(executor));
  session.refine_calibration(recording->calibration(), {});
  MappedRecording mapped;
  mapped.frame_times = recording->times();
  for (int i = 0; i < recording->size(); ++i) {
    const std::optional<ImageFrame> images = recording->read(i);
    if (!images) continue;
    const FrameReport report = session.process(extractor.extract(*images).frame);
    if (report.map_from_body) mapped.causal.push_back({report.time, *report.map_from_body});
  }
  session.finish();
  mapped.final = session.final_trajectory();
  mapped.map = session.map().online();
  return mapped;
}

int frames_without_pose(const MappedRecording& mapped) {
  const Coverage coverage = coverage_of_frames(mapped.final, mapped.frame_times);
  return coverage.expected - coverage.with_pose;
}

double position_error(const Trajectory& estimate, const Trajectory& truth, const AssociationOptions& options) {
  const auto error = absolute_trajectory_error(associate(estimate, truth, options), Scale::fixed);
  return error ? error->translation.rmse : std::numeric_limits<double>::infinity();
}

std::string written(const Trajectory& trajectory) {
  const fs::path path = fs::temp_directory_path() / ("byre_accuracy." + std::to_string(getpid()) + ".txt");
  write_trajectory(trajectory, path);
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  fs::remove(path);
  return bytes.str();
}

std::optional<fs::path> find_recording(const fs::path& name) {
  const fs::path folder = data_folder() / name;
  return fs::is_directory(folder) ? std::optional(folder) : std::nullopt;
}

std::string missing(const fs::path& name) {
  return "no recording at " + (data_folder() / name).string() + "; set BYRE_DATA to the folder with " + name.string();
}

const Vocabulary& shipped_vocabulary() {
  static const Vocabulary loaded = Vocabulary::load(default_vocabulary_path());
  return loaded;
}

}  // namespace byre
