#pragma once

#include "byre/map/map_file.h"
#include "byre/place/place_index.h"

#include <vector>

namespace byre {

// A kept map as missions use it. Never changed once made, so that any number of sessions and threads may share it.
class OfflineMap {
 public:
  // Preconditions: the map is an offline one and holds keyframes; those have words of the vocabulary, see add_words.
  OfflineMap(Map map, const Vocabulary& vocabulary, std::vector<SourceRecording> recordings = {});

  const Map& map() const { return map_; }
  const PlaceIndex& places() const { return places_; }

  const std::vector<SourceRecording>& recordings() const { return recordings_; }  // what the map was made from

  // How exactly its frame is known where a keyframe stands: what a keyframe's pose is uncertain by relative to the
  // others on the whole, the median of them. The same in all directions.
  const Matrix6& frame_covariance() const { return frame_covariance_; }

  // Keyframes near a camera that look in a similar direction, nearest first. Nearness is distance in metres, and a
  // metre for each radian between the directions.
  std::vector<KeyframeId> keyframes_near(const Pose& camera_from_world, double max_distance, int max_count) const;

 private:
  Map map_;
  PlaceIndex places_;
  std::vector<SourceRecording> recordings_;
  struct View {
    KeyframeId keyframe;
    Eigen::Vector3d camera_in_world;
    Eigen::Vector3d viewing_direction;  // unit length, in world
  };
  std::vector<View> views_;
  Matrix6 frame_covariance_ = Matrix6::Zero();
};

}  // namespace byre
