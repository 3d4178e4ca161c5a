#pragma once

#include "byre/input/output_file.h"
#include "byre/viewer/camera_picture.h"
#include "byre/viewer/plan_picture.h"

#include <filesystem>
#include <memory>
#include <string>

namespace cv {
class VideoWriter;
}

namespace byre {

// A frame and its place on the ground as one picture: the plan below the camera where the ground is wide, else beside
// it. The ground is that of the options, so that all pictures of a run are of one size. Precondition: options.shown is
// set.
Picture frame_and_plan(const FrameScene& frame, const CameraPictureOptions& camera_options, const PlanScene& plan,
                       PlanPictureOptions plan_options);

// An MP4 file of pictures of one size, H.264 where the system's FFmpeg can, else MPEG-4.
class RunVideo {
 public:
  // Throws InputError if no such file can be written.
  RunVideo(const std::filesystem::path& file, double frame_rate_hz, int width, int height);
  ~RunVideo();

  // Cut off, or filled up with white, where it is of another size.
  void add(const Picture& picture);

  // Gives the file its name. Call once, after the last picture.
  void finish();

  bool plays_in_browsers() const { return is_h264_; }

 private:
  OutputFile file_;
  int width_;  // pixels, even as the format wants it
  int height_;
  bool is_h264_ = false;
  std::unique_ptr<cv::VideoWriter> writer_;
};

}  // namespace byre
