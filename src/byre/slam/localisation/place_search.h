#pragma once

#include "byre/pose_hint.h"
#include "byre/slam/localisation/place_bounds.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/places/offline_map.h"
#include "byre/slam/places/place_view.h"
#include "byre/trajectory.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Whether a pose is within the hint's radius and turn.
bool is_near(const PoseHint& hint, const Pose& map_from_body);

// The last hint given, until it expires.
class ActiveHint {
 public:
  void clear() { hint_.reset(); }
  void set_hint(const PoseHint& hint);  // a non-finite hint withdraws the last one
  // Once for each frame, in order of time.
  void expire(Timestamp frame);
  const std::optional<PoseHint>& get() const { return hint_; }  // empty: none, or expired

 private:
  std::optional<PoseHint> hint_;
  std::optional<Timestamp> first_frame_;  // first frame after set_hint()
};

struct PlaceSearchOptions {
  LocaliseOptions localise;
  PlaceBoundsOptions bounds;
};

// A frame to localise without a prediction.
struct PlaceQuery {
  const Frame& frame;
  const Rig& rig;
  std::optional<PoseHint> hint{};             // limits the search; empty: the whole map
  std::optional<PlaceBounds::Reach> reach{};  // motion since the last trusted pose
  ImageMask hidden{};                         // image cells without expected points
};

// Localisation in the offline map alone, restricted to possible places.
struct BoundedLocalisation {
  Localisation found;
  DistrustReason refused = DistrustReason::none;  // why a place that shows the frame was rejected
};

BoundedLocalisation localise_in(const OfflineMap& offline, const PlaceQuery& query, const PlaceSearchOptions& options);

// Pose of a frame in the offline map.
struct FoundPlace {
  Pose camera_from_offline;
  double median_depth = 0.0;  // metres, of the matched points
  PlaceView view{};           // part of the map in view
};

// Result of localising a frame in the offline map without a prediction.
struct PlaceSearch {
  Timestamp time{};                               // time of the frame
  Rig rig{};                                      // cameras of the frame
  std::optional<FoundPlace> found{};              // the only place that fits, places[0]; else empty
  DistrustReason refused = DistrustReason::none;  // see BoundedLocalisation
  std::vector<FoundPlace> places{};               // places that show the frame, most inliers first
  std::optional<FocalEvidence> focal{};           // see Localisation
};
PlaceSearch search_place(const OfflineMap& offline, const PlaceQuery& query, const PlaceSearchOptions& options);

// Same in several maps with words of one vocabulary, by one query: candidates of all maps compete by their scores, but
// each map keeps its best. Takes little longer than in one map. query: without hint and reach, which refer to one map.
std::vector<PlaceSearch> search_places(std::span<const std::shared_ptr<const OfflineMap>> maps, const PlaceQuery& query,
                                       const PlaceSearchOptions& options);

struct ImageLocalisation {
  Localisation found;
  int map = 0;  // index of the map of `found`
};

// Localises a frame by itself, without frames before it, in one of several maps. Of the places that fit, in all maps,
// the likeliest is taken if all others are much less likely: by the points that a frame should show there, and by tags.
// Precondition: at least one map.
ImageLocalisation localise_image(std::span<const OfflineMap* const> maps, const Frame& frame, const Rig& rig);

}  // namespace byre
