#include "byre/viewer/run_video.h"

#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"
#include "byre/viewer/picture_shapes.h"

#include <cassert>
#include <utility>

namespace byre {
namespace {

int even(int length) {
  return length + length % 2;
}

}  // namespace

Picture frame_and_plan(const FrameScene& frame, const CameraPictureOptions& camera_options, const PlanScene& plan,
                       PlanPictureOptions plan_options) {
  constexpr double kWide = 1.5;
  constexpr int kLegend = 100;  // pixels, approximate
  assert(plan_options.shown);
  Picture camera = camera_picture(frame, camera_options);
  const Eigen::Vector2d size = plan_options.shown->sizes();
  const bool is_wide = size.x() > kWide * size.y();
  plan_options.width = camera.width;
  plan_options.height = is_wide ? camera.height : camera.height - kLegend;
  plan_options.whole_legend = true;
  const Picture ground = plan_picture(plan, plan_options);
  return is_wide ? vconcat(std::move(camera), ground) : hconcat(std::move(camera), ground);
}

RunVideo::RunVideo(const std::filesystem::path& file, double frame_rate_hz, int width, int height)
    : file_(file, FileContent::video), width_(even(width)), height_(even(height)) {
  const cv::Size size(width_, height_);
  const std::string name = file_.temporary().string();
  writer_ = open_video_writer(name, "avc1", frame_rate_hz, size);
  is_h264_ = writer_->isOpened();
  if (!is_h264_) writer_ = open_video_writer(name, "mp4v", frame_rate_hz, size);
  if (writer_->isOpened()) return;
  throw InputError(file.string(), "cannot be written as a video",
                   "use a .mp4 name in an existing folder, and OpenCV with FFmpeg");
}

RunVideo::~RunVideo() = default;

void RunVideo::add(const Picture& picture) {
  const cv::Mat drawn = rasterised(picture);
  if (drawn.cols == width_ && drawn.rows == height_) return writer_->write(drawn);
  cv::Mat frame(height_, width_, CV_8UC3, cv::Scalar::all(255));
  const cv::Rect part(0, 0, std::min(width_, drawn.cols), std::min(height_, drawn.rows));
  drawn(part).copyTo(frame(part));
  writer_->write(frame);
}

void RunVideo::finish() {
  writer_->release();
  file_.publish();
}

}  // namespace byre
