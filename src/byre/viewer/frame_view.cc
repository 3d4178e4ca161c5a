#include "byre/viewer/frame_view.h"

#include "byre/features/rectify.h"

#include <cassert>

namespace byre {

struct FrameView::State {
  Rectifier rectifier;
};

FrameView::FrameView(const Calibration& calibration) : state_(new State{Rectifier(calibration)}) {}

FrameView::~FrameView() = default;

const Rig& FrameView::rig() const {
  return state_->rectifier.rig();
}

FrameScene FrameView::scene_of(const Image& left, const FrameReport& report, const std::vector<SeenPoint>& seen) const {
  const cv::Mat pixels(left.height, left.width, CV_8U, const_cast<std::uint8_t*>(left.pixels.data()));
  const cv::Mat rectified = state_->rectifier.left(pixels);
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
