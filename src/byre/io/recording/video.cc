#include "byre/io/recording/video.h"

#include "byre/base/text_file.h"
#include "byre/geometry/baseline.h"
#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"
#include "byre/io/image/image_names.h"
#include "byre/io/recording/frame_selection.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<cv::VideoCapture> open_capture(const fs::path& file) {
  // A fixed decoder, so that results do not depend on the installed ones.
  std::unique_ptr<cv::VideoCapture> capture = open_video_capture(file.string());
  if (!capture->isOpened()) {
    throw InputError(file.string(), "cannot be opened as a video",
                     "check that the file is complete, or extract its images");
  }
  capture->set(cv::CAP_PROP_ORIENTATION_AUTO, 0);  // keeps the orientation of the calibration
  return capture;
}

// Counts the frames if the container does not state their number.
std::size_t frame_count(const fs::path& file, const cv::VideoCapture& opened) {
  const double stated = opened.get(cv::CAP_PROP_FRAME_COUNT);
  if (stated >= 1.0) return static_cast<std::size_t>(stated);
  std::unique_ptr<cv::VideoCapture> capture = open_capture(file);
  std::size_t count = 0;
  while (capture->grab()) ++count;
  if (count == 0)
    throw InputError(file.string(), "contains no frame that can be decoded", "check that the file is complete");
  return count;
}

// Frame rate that the container states; empty if it is not plausible.
std::optional<double> stated_frame_rate(const cv::VideoCapture& capture) {
  constexpr double kHighest = 1000.0;
  const double rate = capture.get(cv::CAP_PROP_FPS);
  return rate > 0.0 && rate <= kHighest ? std::optional(rate) : std::nullopt;
}

Image to_grey(const cv::Mat& frame) {
  Image image{frame.cols, frame.rows, std::vector<std::uint8_t>(frame.total())};
  cv::Mat grey(frame.rows, frame.cols, CV_8U, image.pixels.data());
  if (frame.channels() == 1) {
    frame.copyTo(grey);
  } else {
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  }
  return image;
}

class Video final : public Recording {
 public:
  Video(fs::path file, std::unique_ptr<cv::VideoCapture> capture, Calibration calibration,
        std::vector<std::string> warnings)
      : file_(std::move(file)),
        calibration_(std::move(calibration)),
        warnings_(std::move(warnings)),
        capture_(std::move(capture)) {}

  // Keeps the frames in range. Call it once, before reading.
  void select(std::vector<std::size_t> numbers, const std::vector<Timestamp>& times_of_all) {
    for (const std::size_t number : numbers) times_.push_back(times_of_all[number]);
    numbers_ = std::move(numbers);
  }

  const Calibration& calibration() const override { return calibration_; }
  const std::vector<Timestamp>& times() const override { return times_; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  std::optional<ImageFrame> read(int index) override;

 private:
  bool grab(std::size_t number);

  fs::path file_;                              // constant after construction
  Calibration calibration_;                    // constant after construction
  std::vector<std::size_t> numbers_;           // numbers in the file of the frames in range, constant after select
  std::vector<Timestamp> times_;               // constant after select
  std::vector<std::string> warnings_;          // grows with read
  std::unique_ptr<cv::VideoCapture> capture_;  // positioned at frame next_
  std::size_t next_ = 0;
};

// Decodes frames sequentially: skips frames in between, and reopens the file to go back. Seeking is inexact for many
// videos.
bool Video::grab(std::size_t number) {
  if (number < next_) {
    capture_ = open_capture(file_);
    next_ = 0;
  }
  while (next_ <= number) {
    if (!capture_->grab()) return false;
    ++next_;
  }
  return true;
}

std::optional<ImageFrame> Video::read(int index) {
  assert(index >= 0 && index < size());
  const std::size_t number = numbers_[static_cast<std::size_t>(index)];
  cv::Mat frame;
  std::string reason;
  try {
    if (grab(number) && capture_->retrieve(frame) && !frame.empty()) {
      return ImageFrame{times_[static_cast<std::size_t>(index)], to_grey(frame), std::nullopt};
    }
  } catch (const cv::Exception& exception) {  // pixel formats that cannot be converted
    reason = ": " + exception.err;
  }
  warnings_.push_back(file_.string() + ": frame " + std::to_string(number) + " cannot be decoded" + reason);
  return std::nullopt;
}

}  // namespace

bool is_video_file(const fs::path& path) {
  constexpr std::array<std::string_view, 10> kExtensions = {".mp4", ".mov", ".avi", ".mkv",  ".webm",
                                                            ".m4v", ".mpg", ".ts",  ".mpeg", ".wmv"};
  return fs::is_regular_file(path) &&
         std::ranges::find(kExtensions, lower_case(path.extension().string())) != kExtensions.end();
}

std::unique_ptr<Recording> open_video(const fs::path& file, const FrameRange& range, const OpenOptions& options) {
  std::unique_ptr<cv::VideoCapture> capture = open_capture(file);
  const CalibrationWithSource whole = calibration_for(file.parent_path(), options);
  CalibrationWithSource calibration = choose_calibration(whole, {}, options.camera, file);
  complete_size(calibration.cameras.left, static_cast<int>(capture->get(cv::CAP_PROP_FRAME_WIDTH)),
                static_cast<int>(capture->get(cv::CAP_PROP_FRAME_HEIGHT)), calibration.left_size);
  with_checked_baseline(calibration.cameras, options.baseline, place_of_calibration(file, options), "--baseline ");
  require_calibrated_size(static_cast<int>(capture->get(cv::CAP_PROP_FRAME_WIDTH)),
                          static_cast<int>(capture->get(cv::CAP_PROP_FRAME_HEIGHT)), calibration.cameras.left,
                          calibration.left_size);
  const std::optional<double> rate = options.frame_rate_hz ? options.frame_rate_hz : stated_frame_rate(*capture);
  std::vector<std::string> warnings = whole.warnings;
  if (!rate) warnings.push_back(file.string() + ": has no frame rate; 30 frames per second are assumed");
  const std::vector<Timestamp> times = uniform_times(frame_count(file, *capture), rate.value_or(kAssumedFrameRate));
  auto video = std::make_unique<Video>(file, std::move(capture), calibration.cameras, std::move(warnings));
  video->select(frames_in_range(times, range, file), times);
  return video;
}

}  // namespace byre
