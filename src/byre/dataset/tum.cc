#include "byre/dataset/recording_index.h"
#include "byre/dataset/timed_files.h"
#include "byre/input/input_error.h"
#include "byre/input/text_file.h"

namespace byre {
namespace {

namespace fs = std::filesystem;

// A line of rgb.txt: "1305031102.175304 rgb/1305031102.175304.png".
TimedFile parse_timed_file(const TextLine& line, const fs::path& folder, const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  const std::optional<Timestamp> time = parse_seconds(fields.front());
  if (!time) throw InputError(place, "\"" + std::string(fields.front()) + "\" is not a time in seconds");
  if (fields.size() < 2 || fields[1].empty()) throw InputError(place, "names no image file");
  return {*time, folder / fields[1]};
}

}  // namespace

RecordingIndex index_tum(const fs::path& folder, const OpenOptions& options) {
  const fs::path list = folder / "rgb.txt";
  std::vector<TimedFile> files;
  for (const TextLine& line : read_lines(list)) {
    const std::string place = place_of(list, line);
    files.push_back(parse_timed_file(line, folder, place));
    if (files.size() > 1 && files.back().time <= files[files.size() - 2].time) {
      throw InputError(place, "the time stamp is not later than the one before it", "sort the lines by time");
    }
  }
  if (files.empty()) throw InputError(list.string(), "lists no images");
  return {calibration_for(folder, options), frames_of(files, {})};
}

}  // namespace byre
