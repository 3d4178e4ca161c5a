#include "byre/io/recording/frame_selection.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool is_within(const FrameRange& range, int number, double seconds) {
  if (number < range.first || (range.last && number >= *range.last)) return false;
  return (!range.start_s || seconds >= *range.start_s) && (!range.end_s || seconds < *range.end_s);
}

std::string describe_extent(const std::vector<Timestamp>& times) {
  const double span = to_seconds(times.back() - times.front());
  return "the recording has " + std::to_string(times.size()) + " frames in " + std::to_string(span) + " s";
}

CalibrationWithSource without_right(CalibrationWithSource calibration) {
  calibration.cameras.right.reset();
  return calibration;
}

CalibrationWithSource without_depth(CalibrationWithSource calibration) {
  calibration.cameras.depth.reset();
  return calibration;
}

// Precondition: there is a right camera.
CalibrationWithSource right_alone(const CalibrationWithSource& calibration) {
  const Calibration& pair = calibration.cameras;
  const Pose body_from_right = pair.body_from_left * inverse(pair.right->right_from_left);
  CalibrationWithSource alone{{pair.right->camera, std::nullopt, body_from_right}, calibration.right_size, ""};
  alone.cameras.readout_time = pair.readout_time;
  return alone;
}

bool has_right_image(const FrameFiles& frame) {
  return frame.right.has_value();
}

void require_pair(const CalibrationWithSource& calibration, const ExtraImages& extra, const fs::path& path) {
  if (extra.right && calibration.cameras.right) return;
  throw InputError(path.string(),
                   extra.right ? "has a calibration of one camera only" : "has images of one camera only",
                   "select one camera: left, or right of a calibrated pair");
}

void require_depth(const CalibrationWithSource& calibration, const ExtraImages& extra, const fs::path& path) {
  if (extra.depth && calibration.cameras.depth) return;
  throw InputError(path.string(), "has no depth images",
                   "give the folder of an RGB-D recording with depth.txt (TUM), or select the camera alone: "
                   "left");
}

constexpr std::array kChoices = {CameraChoice::stereo, CameraChoice::left, CameraChoice::right, CameraChoice::rgbd};

std::optional<int> parse_index(std::string_view text) {
  const auto value = parse_whole<int>(text);
  return value && *value >= 0 ? value : std::nullopt;
}

}  // namespace

std::vector<std::size_t> frames_in_range(const std::vector<Timestamp>& times, const FrameRange& range,
                                         const fs::path& path) {
  if (range.stride < 1) throw InputError(path.string(), "the stride of frames must be at least 1");
  std::vector<std::size_t> selected;
  int within = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!is_within(range, static_cast<int>(i), to_seconds(times[i] - times.front()))) continue;
    if (within++ % range.stride == 0) selected.push_back(i);
  }
  if (selected.empty()) throw InputError(path.string(), "the selected range contains no frame", describe_extent(times));
  return selected;
}

CalibrationWithSource choose_calibration(const CalibrationWithSource& calibration, const ExtraImages& extra,
                                         const std::optional<CameraChoice>& choice, const fs::path& path) {
  const bool is_pair = extra.right && calibration.cameras.right;
  switch (choice.value_or(is_pair ? CameraChoice::stereo : CameraChoice::rgbd)) {
    case CameraChoice::right:
      if (calibration.cameras.right) return right_alone(calibration);
      throw InputError(path.string(), "has a calibration without right camera",
                       "give a stereo calibration, or select the left camera");
    case CameraChoice::stereo:
      require_pair(calibration, extra, path);
      return without_depth(calibration);
    case CameraChoice::rgbd:
      if (choice) require_depth(calibration, extra, path);
      return without_right(extra.depth ? calibration : without_depth(calibration));
    case CameraChoice::left:
      break;
  }
  return without_right(without_depth(calibration));
}

void require_calibrated_size(int width, int height, const Camera& camera, const std::string& place) {
  if (width == camera.width && height == camera.height) return;
  throw InputError(place,
                   "is " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                       ", but the images are " + std::to_string(width) + "x" + std::to_string(height),
                   "use a calibration for this image size");
}

ExtraImages extra_images_of(const RecordingIndex& index) {
  return {.right = std::ranges::any_of(index.frames, has_right_image),
          .depth = std::ranges::any_of(index.frames, [](const FrameFiles& frame) { return frame.depth.has_value(); })};
}

RecordingIndex choose_camera(RecordingIndex index, const ExtraImages& extra, const std::optional<CameraChoice>& choice,
                             const fs::path& path) {
  if (extra.right && !index.calibration.cameras.right && !choice) {
    index.warnings.push_back(path.string() + ": the calibration has one camera only; right images are ignored");
  }
  const std::vector<std::string>& warnings = index.calibration.warnings;
  index.warnings.insert(index.warnings.end(), warnings.begin(), warnings.end());
  index.calibration = choose_calibration(index.calibration, extra, choice, path);
  if (index.calibration.cameras.right) return index;
  if (extra.right && choice == CameraChoice::right) {
    std::erase_if(index.frames, [](const FrameFiles& frame) { return !has_right_image(frame); });
    for (FrameFiles& frame : index.frames) frame.left = *frame.right;
  }
  if (index.frames.empty()) throw InputError(path.string(), "no frame in the selected range has a right image");
  for (FrameFiles& frame : index.frames) {
    frame.right.reset();
    if (!index.calibration.cameras.depth) frame.depth.reset();
  }
  return index;
}

std::optional<FrameRange> parse_frames(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::string_view first = text.substr(0, colon), end = text.substr(colon + 1);
  FrameRange range;
  if (!first.empty()) {
    const std::optional<int> index = parse_index(first);
    if (!index) return std::nullopt;
    range.first = *index;
  }
  if (end.empty()) return range;
  range.last = parse_index(end);
  if (!range.last || *range.last <= range.first) return std::nullopt;
  return range;
}

std::optional<CameraChoice> parse_camera(std::string_view text) {
  for (const CameraChoice choice : kChoices) {
    if (text == to_string(choice)) return choice;
  }
  return std::nullopt;
}

}  // namespace byre
