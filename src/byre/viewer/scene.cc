#include "byre/viewer/scene.h"

#include "byre/features/rectify.h"

#include <cassert>

namespace byre {
namespace {

void append(const MapGraph& map, MapScene& scene) {
  for (const PointId id : map.point_ids()) {
    scene.points.push_back({map.find_point(id)->position_in_world.cast<float>(), id.origin});
  }
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
    scene.keyframes.push_back(
        {keyframe.frame.time, inverse(rig.body_from_camera * keyframe.camera_from_world), id.origin});
  }
}

}  // namespace

MapScene scene_of(const MapView& map) {
  MapScene scene;
  if (map.offline() != nullptr) append(*map.offline(), scene);
  append(map.online(), scene);
  return scene;
}

MapScene scene_of(const Map& before, const Map& after, const MapDifference& difference) {
  MapScene scene;
  const auto add = [&scene](const Map& map, const std::vector<int>& points, Origin origin) {
    for (const int id : points) scene.points.push_back({map.position(id).cast<float>(), origin});
  };
  add(before, difference.removed_points, Origin::offline);
  add(after, difference.added_points, Origin::online);
  return scene;
}

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
