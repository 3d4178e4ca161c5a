#pragma once

#include "byre/base/output_file.h"
#include "byre/viewer/camera_picture.h"
#include "byre/viewer/plan_picture.h"

#include <filesystem>
#include <memory>

namespace cv {
class VideoWriter;
}

namespace byre {

// One picture of a frame and its place on the ground: plan below the camera image if the ground is wide, else beside
// it. plan_options fixes the ground, so that all pictures of a run have one size. Precondition: plan_options.shown is
// set.
Picture frame_and_plan(const FrameScene& frame, const CameraPictureOptions& camera_options, const PlanScene& plan,
                       PlanPictureOptions plan_options);

// MP4 writer for pictures of one size: H.264 if the system's FFmpeg supports it, else MPEG-4.
class RunVideo {
 public:
  // Throws InputError if the file cannot be written.
  RunVideo(const std::filesystem::path& file, double frame_rate_hz, int width, int height);
  ~RunVideo();

  // Crops or pads (white) pictures of another size.
  void add(const Picture& picture);

  // Moves the file to its final name. Call once, after the last picture.
  void finish();

  bool plays_in_browsers() const { return is_h264_; }

 private:
  OutputFile file_;
  int width_;  // pixels, even as required by the codec
  int height_;
  bool is_h264_ = false;
  std::unique_ptr<cv::VideoWriter> writer_;
};

}  // namespace byre
