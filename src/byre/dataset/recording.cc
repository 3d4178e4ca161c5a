#include "byre/dataset/recording.h"

#include "byre/dataset/image_file.h"
#include "byre/dataset/recording_index.h"
#include "byre/evaluation/trajectory_file.h"
#include "byre/input/input_error.h"

#include <cassert>
#include <cstdio>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

class ImageFiles final : public Recording {
 public:
  explicit ImageFiles(RecordingIndex index) : index_(std::move(index)) {
    for (const FrameFiles& frame : index_.frames) times_.push_back(frame.time);
  }

  const Calibration& calibration() const override { return index_.calibration; }
  const std::vector<Timestamp>& times() const override { return times_; }
  std::optional<ImageFrame> read(int index) override;
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  std::optional<Image> read_calibrated(const fs::path& path, const Camera& camera);
  std::optional<Image> read_right(const FrameFiles& files);

  RecordingIndex index_;               // constant after construction
  std::vector<Timestamp> times_;       // constant after construction
  std::vector<std::string> warnings_;  // grows with read
};

std::optional<ImageFrame> ImageFiles::read(int index) {
  assert(index >= 0 && index < size());
  const FrameFiles& files = index_.frames[static_cast<std::size_t>(index)];
  std::optional<Image> left = read_calibrated(files.left, index_.calibration.left);
  if (!left) return std::nullopt;
  return ImageFrame{files.time, std::move(*left), read_right(files)};
}

std::optional<Image> ImageFiles::read_right(const FrameFiles& files) {
  if (!index_.calibration.right) return std::nullopt;
  if (files.right) return read_calibrated(*files.right, index_.calibration.right->camera);
  warnings_.push_back(files.left.string() + ": has no right image of the same time");
  return std::nullopt;
}

std::optional<Image> ImageFiles::read_calibrated(const fs::path& path, const Camera& camera) {
  std::optional<Image> image = read_image(path);
  if (!image) {
    warnings_.push_back(path.string() + (fs::exists(path) ? ": is not a whole image" : ": does not exist"));
    return std::nullopt;
  }
  if (image->width == camera.width && image->height == camera.height) return image;
  warnings_.push_back(path.string() + ": is " + std::to_string(image->width) + "x" + std::to_string(image->height) +
                      " instead of " + std::to_string(camera.width) + "x" + std::to_string(camera.height));
  return std::nullopt;
}

bool is_within(const FrameRange& range, int number, double seconds) {
  if (number < range.first || (range.last && number >= *range.last)) return false;
  return (!range.start_s || seconds >= *range.start_s) && (!range.end_s || seconds < *range.end_s);
}

std::string describe(const std::vector<FrameFiles>& frames) {
  const double span = to_seconds(frames.back().time - frames.front().time);
  return "it holds " + std::to_string(frames.size()) + " frames in " + std::to_string(span) + " s";
}

// Precondition: frames is not empty.
std::vector<FrameFiles> select(const std::vector<FrameFiles>& frames, const FrameRange& range, const fs::path& folder) {
  if (range.stride < 1) throw InputError(folder.string(), "the stride of frames must be at least 1");
  std::vector<FrameFiles> selected;
  int within = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double seconds = to_seconds(frames[i].time - frames.front().time);
    if (!is_within(range, static_cast<int>(i), seconds)) continue;
    if (within++ % range.stride == 0) selected.push_back(frames[i]);
  }
  if (selected.empty()) throw InputError(folder.string(), "no frame lies in the range asked for", describe(frames));
  return selected;
}

}  // namespace

Image first_readable(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (std::optional<Image> image = read_image(file)) return std::move(*image);
  }
  throw InputError(files.front().parent_path().string(), "none of the images listed can be read",
                   "check that the folder is complete");
}

RecordingFormat guess_format(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder.string(), "is no folder", "give the folder of a recording");
  if (find_mav_folder(folder)) return RecordingFormat::euroc;
  if (fs::exists(folder / "calib.txt") || fs::is_directory(folder / "image_0")) return RecordingFormat::kitti;
  throw InputError(folder.string(), "holds no recording that byre knows",
                   "looked for mav0/cam0 or cam0 (EuRoC) and calib.txt or image_0 (KITTI odometry)");
}

std::unique_ptr<Recording> open_recording(const fs::path& folder, const FrameRange& range) {
  RecordingIndex index = guess_format(folder) == RecordingFormat::euroc ? index_euroc(folder) : index_kitti(folder);
  index.frames = select(index.frames, range, folder);
  return std::make_unique<ImageFiles>(std::move(index));
}

std::optional<fs::path> find_ground_truth(const fs::path& folder) {
  if (guess_format(folder) == RecordingFormat::euroc) return find_euroc_ground_truth(folder);
  const fs::path sequence = fs::canonical(folder);
  const fs::path poses = sequence.parent_path().parent_path() / "poses" / (sequence.filename().string() + ".txt");
  return fs::exists(poses) ? std::optional(poses) : std::nullopt;
}

}  // namespace byre
