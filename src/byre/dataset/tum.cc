#include "byre/dataset/recording_index.h"
#include "byre/dataset/timed_files.h"
#include "byre/input/text_file.h"
#include "byre/input_error.h"

#include <algorithm>

namespace byre {
namespace {

namespace fs = std::filesystem;

// A line of rgb.txt or depth.txt: "1305031102.175304 rgb/1305031102.175304.png".
TimedFile parse_tum_line(const TextLine& line, const fs::path& folder, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  const std::optional<Timestamp> time = parse_seconds(fields.front());
  if (!time) throw InputError(place, "\"" + std::string(fields.front()) + "\" is not a time in seconds");
  if (fields.size() < 2 || fields[1].empty()) throw InputError(place, "names no image file");
  return {*time, folder / fields[1]};
}

std::vector<TimedFile> read_list(const fs::path& folder, const char* name) {
  const fs::path list = folder / name;
  std::vector<TimedFile> files;
  for (const TextLine& line : read_lines(list)) {
    const std::string place = place_of(list, line);
    files.push_back(parse_tum_line(line, folder, place));
    if (files.size() > 1 && files.back().time <= files[files.size() - 2].time) {
      throw InputError(place, "the time stamp is not later than the one before it", "sort the lines by time");
    }
  }
  if (files.empty()) throw InputError(list.string(), "lists no images");
  return files;
}

bool is_there(const FrameFiles& frame) {
  return frame.depth && fs::exists(*frame.depth);
}

// Depth images are often left out of copies, whose lists still name them.
void add_listed_depth(const fs::path& folder, const OpenOptions& options, RecordingIndex& index) {
  add_depth(index.frames, read_list(folder, "depth.txt"));
  if (std::ranges::none_of(index.frames, is_there)) {
    index.warnings.push_back((folder / "depth.txt").string() +
                             ": none of its images is there and within 20 ms of a frame, so depth is left out");
    for (FrameFiles& frame : index.frames) frame.depth.reset();
    return;
  }
  const PlacedDepthCamera depth = depth_camera_for(folder, options);
  index.calibration.cameras.depth = depth.camera;
  index.calibration.depth_size = depth.size;
}

}  // namespace

RecordingIndex index_tum(const fs::path& folder, const OpenOptions& options) {
  RecordingIndex index{calibration_for(folder, options), frames_of(read_list(folder, "rgb.txt"), {})};
  const bool wants_depth = !options.camera || options.camera == CameraChoice::rgbd;
  if (wants_depth && fs::exists(folder / "depth.txt")) add_listed_depth(folder, options, index);
  return index;
}

}  // namespace byre
