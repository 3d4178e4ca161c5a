#include "byre/base/text_file.h"
#include "byre/geometry/evaluation/trajectory_lines.h"
#include "byre/input_error.h"
#include "byre/io/recording/recording_index.h"
#include "byre/io/recording/timed_files.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

// A line of rgb.txt or depth.txt: "1305031102.175304 rgb/1305031102.175304.png". Whole numbers too large for seconds
// are nanoseconds.
TimedFile parse_tum_line(const TextLine& line, const fs::path& folder, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  const Timestamp time = parse_time({line.number, std::string(fields.front())}, place);
  if (fields.size() < 2 || fields[1].empty()) throw InputError(place, "has no name of an image file");
  return {time, folder / fields[1]};
}

// rgb: clock of the colour images, for depth images.
RestoredFiles read_list(const fs::path& folder, const char* name, const SensorClock& rgb = {}) {
  const fs::path list = folder / name;
  std::vector<TimedFile> files;
  for (const TextLine& line : read_lines(list)) {
    files.push_back(parse_tum_line(line, folder, place_of(list, line)));
  }
  if (files.empty()) throw InputError(list.string(), "lists no images");
  return restore_files(files, list.string(), rgb);
}

bool has_depth(const FrameFiles& frame) {
  return frame.depth && fs::exists(*frame.depth);
}

// Copies of recordings often lack depth images that the lists still name.
void add_listed_depth(const fs::path& folder, const OpenOptions& options, RecordingIndex& index) {
  const RestoredFiles depth_files = read_list(folder, "depth.txt", index.clock);
  index.warnings.insert(index.warnings.end(), depth_files.warnings.begin(), depth_files.warnings.end());
  add_depth(index.frames, depth_files.files);
  if (std::ranges::none_of(index.frames, has_depth)) {
    index.warnings.push_back((folder / "depth.txt").string() +
                             ": no listed image exists within 20 ms of a frame; depth is ignored");
    for (FrameFiles& frame : index.frames) frame.depth.reset();
    return;
  }
  const DepthCameraWithSource depth = depth_camera_for(folder, options);
  index.calibration.cameras.depth = depth.camera;
  index.calibration.depth_size = depth.size;
}

}  // namespace

RecordingIndex index_tum(const fs::path& folder, const OpenOptions& options) {
  RestoredFiles images = read_list(folder, "rgb.txt");
  RecordingIndex index{calibration_for(folder, options), frames_of(images.files, {}, {}), std::move(images.warnings),
                       std::move(images.corrections), std::move(images.clock)};
  const bool wants_depth = !options.camera || options.camera == CameraChoice::rgbd;
  if (wants_depth && fs::exists(folder / "depth.txt")) add_listed_depth(folder, options, index);
  return index;
}

}  // namespace byre
