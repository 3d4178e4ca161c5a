#include "byre/dataset/frame_selection.h"

#include "byre/input/input_error.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool is_within(const FrameRange& range, int number, double seconds) {
  if (number < range.first || (range.last && number >= *range.last)) return false;
  return (!range.start_s || seconds >= *range.start_s) && (!range.end_s || seconds < *range.end_s);
}

std::string describe(const std::vector<Timestamp>& times) {
  const double span = to_seconds(times.back() - times.front());
  return "it holds " + std::to_string(times.size()) + " frames in " + std::to_string(span) + " s";
}

PlacedCalibration left_alone(PlacedCalibration calibration) {
  calibration.cameras.right.reset();
  return calibration;
}

// Precondition: there is a right camera.
PlacedCalibration right_alone(const PlacedCalibration& calibration) {
  const Calibration& pair = calibration.cameras;
  const Pose body_from_right = pair.body_from_left * inverse(pair.right->right_from_left);
  return {{pair.right->camera, std::nullopt, body_from_right}, calibration.right_size, ""};
}

bool has_right_image(const FrameFiles& frame) {
  return frame.right.has_value();
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
  if (selected.empty()) throw InputError(path.string(), "no frame lies in the range asked for", describe(times));
  return selected;
}

PlacedCalibration choose_calibration(const PlacedCalibration& calibration, bool has_pairs,
                                     const std::optional<CameraChoice>& choice, const fs::path& path) {
  const bool has_right = calibration.cameras.right.has_value();
  const bool is_pair = has_pairs && has_right;
  if (choice == CameraChoice::right) {
    if (has_right) return right_alone(calibration);
    throw InputError(path.string(), "has no right camera in its calibration",
                     "give the calibration of a pair, or take the left camera");
  }
  if (choice == CameraChoice::stereo && !is_pair) {
    throw InputError(path.string(), has_pairs ? "is calibrated for one camera only" : "has images of one camera only",
                     "take that camera alone: left, or right of a calibrated pair");
  }
  return is_pair && choice != CameraChoice::left ? calibration : left_alone(calibration);
}

void require_calibrated_size(int width, int height, const Camera& camera, const std::string& place) {
  if (width == camera.width && height == camera.height) return;
  throw InputError(place,
                   "is " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                       ", but the images are " + std::to_string(width) + "x" + std::to_string(height),
                   "use a calibration made at the size of the images");
}

bool has_pairs(const RecordingIndex& index) {
  return std::ranges::any_of(index.frames, has_right_image);
}

RecordingIndex choose_camera(RecordingIndex index, bool has_pairs, const std::optional<CameraChoice>& choice,
                             const fs::path& path) {
  if (has_pairs && !index.calibration.cameras.right && !choice) {
    index.warnings.push_back(path.string() + ": is calibrated for one camera only, so its right images are left out");
  }
  index.calibration = choose_calibration(index.calibration, has_pairs, choice, path);
  if (index.calibration.cameras.right) return index;
  if (has_pairs && choice == CameraChoice::right) {
    std::erase_if(index.frames, [](const FrameFiles& frame) { return !has_right_image(frame); });
    for (FrameFiles& frame : index.frames) frame.left = *frame.right;
  }
  if (index.frames.empty()) throw InputError(path.string(), "no frame in the range asked for has a right image");
  for (FrameFiles& frame : index.frames) frame.right.reset();
  return index;
}

}  // namespace byre
