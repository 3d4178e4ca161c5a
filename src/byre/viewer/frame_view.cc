#include "byre/viewer/frame_view.h"

#include <cassert>

namespace byre {

FrameScene FrameView::scene_of(const Image& left, const FrameReport& report, const std::vector<SeenPoint>& seen) const {
  const cv::Mat pixels(left.height, left.width, CV_8U, const_cast<std::uint8_t*>(left.pixels.data()));
  const cv::Mat rectified = rectifier_.left(pixels);
  assert(rectified.isContinuous());
  FrameScene scene;
  scene.report = report;
  scene.left.width = rectified.cols;
  scene.left.height = rectified.rows;
  scene.left.pixels.assign(rectified.datastart, rectified.dataend);
  scene.seen = seen;
  return scene;
}

}  // namespace byre
