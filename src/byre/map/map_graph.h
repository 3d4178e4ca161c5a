#pragma once

#include "byre/base/scratch_memory.h"
#include "byre/base/shared.h"
#include "byre/features.h"
#include "byre/geometry/rectified_change.h"
#include "byre/input_error.h"
#include "byre/map/block_list.h"
#include "byre/map/ids.h"
#include "byre/map/stored_picture.h"

#include <cassert>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// One feature of one keyframe.
struct Observation {
  KeyframeId keyframe;
  int feature = 0;
  auto operator<=>(const Observation&) const = default;
};

struct MapPoint {
  Eigen::Vector3d position_in_world = Eigen::Vector3d::Zero();
  // Covariance of the position, square metres. In double, because rounding to float may lose positive definiteness.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector3f mean_viewing_direction = Eigen::Vector3f::UnitZ();  // unit length, camera to point
  Descriptor descriptor{};                                            // the most central descriptor of its observations
  float min_distance = 0.0f;                                          // metres, range in which the descriptor is valid
  float max_distance = 0.0f;
  Observation reference;  // observation whose patch defines the point in the image
};

// Optional point id in a third of the memory of std::optional, since each feature of each keyframe has one.
class OptionalPoint {
 public:
  OptionalPoint() = default;
  OptionalPoint(std::nullopt_t) {}
  // Precondition: the number is below 2^31 - 1.
  OptionalPoint(PointId id) : bits_(id.number << 1U | static_cast<std::uint32_t>(id.origin)) {
    assert(id.number < kNone >> 1U);
  }
  OptionalPoint(const std::optional<PointId>& id) : OptionalPoint(id ? OptionalPoint(*id) : OptionalPoint()) {}

  bool has_value() const { return bits_ != kNone; }
  explicit operator bool() const { return has_value(); }
  operator std::optional<PointId>() const { return has_value() ? std::optional(**this) : std::nullopt; }
  // Precondition: has_value().
  PointId operator*() const { return {static_cast<Origin>(bits_ & 1U), bits_ >> 1U}; }
  auto operator->() const { return Held{**this}; }

  void reset() { bits_ = kNone; }

  bool operator==(const OptionalPoint&) const = default;
  bool operator==(const std::optional<PointId>& other) const { return *this == OptionalPoint(other); }
  bool operator==(PointId other) const { return *this == OptionalPoint(other); }
  bool operator==(std::nullopt_t) const { return !has_value(); }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  struct Held {
    PointId id;
    const PointId* operator->() const { return &id; }
  };

  std::uint32_t bits_ = kNone;  // the number, with the origin in the lowest bit
};

// Measurement of a point by a keyframe's feature: the keypoint, refined against the patch of the point's reference.
struct Sighting {
  OptionalPoint point;                              // a point of this map or of the offline one
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  // full-resolution pixels
  float pixel_sigma = 1.0f;                         // pixels
};

// Features of a keyframe, and the same by another calibration of the camera.
struct RecalibratedFeatures {
  KeyframeId keyframe;
  std::shared_ptr<const Features> before;
  std::shared_ptr<const Features> after;
};

// Observation of an online point by an offline keyframe; part of the online map, because the offline map is constant.
struct ForeignView {
  Observation observation;  // offline keyframe and its feature
  Sighting sighting;        // measurement of the online point
};

// A point and its observations by keyframes of its map, ascending.
struct ObservedPoint {
  MapPoint point;
  std::vector<Observation> observations;
};

using Word = std::uint32_t;  // visual word of a vocabulary, see place/vocabulary.h

struct Keyframe {
  Frame frame;
  int rig = 0;        // index into MapGraph::rigs()
  int recording = 0;  // index into StoredMap::recordings
  Pose camera_from_world;
  // Covariance of delta in exp_pose(delta) * camera_from_world, relative to the map's origin.
  Matrix6 covariance = Matrix6::Zero();
  std::vector<Sighting> sightings;   // one per feature
  std::optional<KeyframeId> parent;  // keyframe of the same map from which it was tracked; empty for the first
  std::vector<Word> words;           // one per feature, or empty before they are computed
  StoredPicture picture = {};        // see Frame::picture; replaces it once encoded
};

// Pose of a removed keyframe relative to its parent, so that frames tracked from it keep their poses.
struct RemovedKeyframe {
  int rig = 0;  // index into MapGraph::rigs()
  KeyframeId parent;
  Pose camera_from_parent;
};

// Contents of a map. Keyframes and points are numbered by their index.
struct MapParts {
  std::vector<Rig> rigs;
  std::vector<Keyframe> keyframes;
  std::vector<MapPoint> points;
};

// A keyframe with common points.
struct Covisible {
  KeyframeId keyframe;
  int shared_points = 0;
};

// Parts of a map that stay in its file until first access. Accessible from several threads at once. References stay
// valid during the lifetime of the source. A damaged file sets damage(), and the part is replaced: a keyframe by one
// without sightings, a point by one without observations.
class MapSource {
 public:
  using WordVisitor = std::function<void(KeyframeId, std::span<const Word>)>;

  virtual ~MapSource() = default;
  // header: the keyframe without features, sightings and words.
  virtual const Keyframe& keyframe(std::uint32_t number, const Keyframe& header) const = 0;
  virtual const ObservedPoint& point(std::uint32_t number) const = 0;
  virtual ScratchVector<Covisible> covisible(std::uint32_t number) const = 0;  // ascending by keyframe
  // Like MapGraph::visit_words. Throws InputError if the words are damaged.
  virtual void visit_words(const WordVisitor& visit) const = 0;
  // First damage found on access, with file, section and remedy; nullptr without damage.
  virtual const InputError* damage() const = 0;
};

// Keyframes, points and observations as a value type. Copies are independent, and share memory until they change: a
// copy takes microseconds, and is a snapshot that another thread may read. Maintains both ends of every observation.
// Containers are dense and indexed by id number; numbers are never reused. Ids passed in must have this map's origin
// unless stated otherwise. Lookup of a removed or foreign id returns nullptr, and changes to it do nothing. Returned
// pointers and references are valid until the next change. Several threads may read a map while none changes it.
//
// A map with a source reads sightings and points from it on first access and keeps them. damage() reports a damaged
// source. The first change reads the whole source, and throws InputError if it is damaged.
class MapGraph {
 public:
  explicit MapGraph(Origin origin) : origin_(origin) {}
  // Builds all at once, many times faster than one by one. Preconditions: each keyframe has one sighting per feature,
  // observes no point twice, and comes after its parent; ids have this origin and are within the parts.
  MapGraph(Origin origin, MapParts parts);
  // Map with a source, of origin offline. Keyframes are headers: without features, sightings and words.
  MapGraph(std::vector<Rig> rigs, std::vector<Keyframe> headers, int point_count,
           std::shared_ptr<const MapSource> source);

  Origin origin() const { return origin_; }

  int add_rig(const Rig& rig);  // index of the rig; equal rigs are stored once
  const std::vector<Rig>& rigs() const { return rigs_; }

  // Adds a keyframe with the observations in its sightings. Drops sightings of removed points and second sightings of a
  // point; adds missing sightings as empty. Replaces a removed parent by its own parent and drops an unknown one.
  KeyframeId add_keyframe(Keyframe keyframe);
  PointId add_point(const MapPoint& point);

  // Sets the feature's sighting. Returns false, without a change, if keyframe or point do not exist, the feature
  // already observes a point, or the keyframe observes this point. An online keyframe may observe an offline point.
  bool add_observation(const Observation& observation, const Sighting& sighting);
  // Removes a point without remaining observations too. A lost reference is replaced by the lowest observation.
  void remove_observation(const Observation& observation);

  // Adds an observation of the sighting's point by an offline keyframe. Foreign views are separate from observations():
  // they are removed with their point, do not keep a point, are never a reference, and do not count as covisibility.
  // Returns false, without a change, if the point does not exist, the keyframe is not offline or observes this point,
  // or the feature observes a point of this map. Precondition: the feature observes no point of its own map.
  bool add_foreign_view(const ForeignView& view);
  void remove_foreign_view(const Observation& observation);

  void remove_point(PointId id);
  // Children get the parent of the removed keyframe, relative to which its pose is kept. A keyframe without a parent is
  // not removed, because the poses of others depend on it.
  void remove_keyframe(KeyframeId id);

  // Moves an existing keyframe out of a map that is consumed keyframe by keyframe; all points remain.
  Keyframe take_keyframe(KeyframeId id);

  void set_words(KeyframeId id, std::vector<Word> words);
  // Replaces the picture of the keyframe's frame.
  void set_picture(KeyframeId id, StoredPicture picture);
  void move_keyframe(KeyframeId id, const Pose& camera_from_world, const Matrix6& covariance);
  // Applies another calibration of the camera to a rig and to its keyframes' features, sightings and poses. Points do
  // not move. made: converted features of some keyframes, ascending; used for keyframes that still have the features
  // before.
  void recalibrate(int rig, const RectifiedChange& change, std::span<const RecalibratedFeatures> made);
  // Replaces a keyframe's features by the same ones at corrected pixels; sightings move along. Points do not move.
  // Precondition: the keyframe's own features, moved.
  void move_features(KeyframeId id, Features moved);
  // Replaces a keyframe's features by equal ones or by the same ones stored elsewhere.
  void replace_features(KeyframeId id, std::shared_ptr<const Features> equal);
  // Drops the patches of all other features. Precondition: indices, ascending.
  void keep_patches(KeyframeId id, std::span<const int> features);
  int rig_of(KeyframeId id) const;  // index into rigs(), also of a removed keyframe; precondition: id once assigned
  // Scales the pose of a removed keyframe relative to its parent. Does nothing for an existing keyframe.
  void scale_removed_keyframe(KeyframeId id, double scale);
  // Replaces a reference that does not observe the point by the point's lowest observation.
  void update_point(PointId id, const MapPoint& point);

  const Keyframe* find_keyframe(KeyframeId id) const;
  // The keyframe without reading the source: features, sightings and words may be missing.
  const Keyframe* keyframe_header(KeyframeId id) const;
  const MapPoint* find_point(PointId id) const;
  std::vector<KeyframeId> keyframe_ids() const;  // ascending
  std::vector<PointId> point_ids() const;        // ascending
  // Calls visit with the words of each keyframe, ascending by keyframe; empty before they are computed.
  void visit_words(const MapSource::WordVisitor& visit) const;
  // See MapSource; nullptr without a source.
  const InputError* damage() const { return source_ ? source_->damage() : nullptr; }
  int keyframe_count() const { return keyframe_count_; }
  int point_count() const { return point_count_; }

  // Observations of a point by keyframes of this map, ascending; also of offline points. Empty for an unknown point.
  const std::vector<Observation>& observations(PointId id) const;
  // Foreign views of a point of this map, ascending by keyframe. Empty for an unknown or offline point.
  const std::vector<ForeignView>& foreign_views(PointId id) const;
  // Features of an offline keyframe that observe points of this map, ascending.
  std::vector<Observation> foreign_observations(KeyframeId offline) const;
  // The point of this map that a feature of an offline keyframe observes.
  std::optional<PointId> point_of_foreign_view(const Observation& observation) const;

  // Keyframes with points in common, most first (ties: lower id first). Maintained incrementally.
  ScratchVector<Covisible> covisible_keyframes(KeyframeId id, int max_count = std::numeric_limits<int>::max()) const;

  // Current pose of a keyframe, also of a removed one, by its parents. Precondition: the id was once assigned.
  Pose camera_from_world(KeyframeId id) const;
  // The keyframe itself if it exists, else its nearest existing ancestor; empty for an id that was never assigned.
  std::optional<KeyframeId> living_ancestor(std::optional<KeyframeId> id) const;

 private:
  struct KeyframeSlot {
    std::optional<Keyframe> keyframe;
    std::optional<RemovedKeyframe> removed;
    std::vector<Covisible> covisible;  // ascending by keyframe
    std::vector<KeyframeId> children;  // ascending
  };

  static constexpr std::uint32_t kGone = 0xFFFFFFFF;  // marks a removed point in point_slots_

  bool was_assigned(KeyframeId id) const;
  const Keyframe* find_own_keyframe(KeyframeId id) const;
  const KeyframeSlot& slot(KeyframeId id) const { return keyframes_[id.number].given(); }
  KeyframeSlot& edit_slot(KeyframeId id) { return keyframes_[id.number].edit(); }
  Keyframe& edit_keyframe(KeyframeId id) { return *edit_slot(id).keyframe; }  // precondition: it exists
  // nullptr for a point that does not exist or is of another origin.
  const ObservedPoint* find_observed(PointId id) const;
  // Like find_observed(), but nullptr for a point still in the source.
  const ObservedPoint* find_slot(PointId id) const;
  ObservedPoint& edit_slot(PointId id) { return points_.edit(point_slots_[id.number]); }  // precondition: it exists
  // Observations of a point, also of an offline one. Precondition: the point exists, or is offline.
  std::vector<Observation>& edit_observations(PointId id);

  // Removes an observation at both ends and returns its point, which is kept even without observations.
  std::optional<PointId> unlink(const Observation& observation);
  void count_shared_point(const std::vector<Observation>& observers, KeyframeId with, int change);
  void add_shared_points(KeyframeId keyframe, KeyframeId with, int change);
  void repair_reference(PointId id);
  void collect_observations();
  void count_covisible_keyframes();
  void read_all() {
    if (source_) read_from_source();
  }
  void read_from_source();
  void reparent_children(KeyframeId id, KeyframeId parent);

  Origin origin_;
  std::vector<Rig> rigs_;
  std::shared_ptr<const MapSource> source_;      // nullptr if everything is in memory
  std::vector<Shared<KeyframeSlot>> keyframes_;  // header with a source
  // Existing points in any order, and free places. Places are reused, because most points are removed sooner or later.
  BlockList<ObservedPoint> points_;
  BlockList<std::uint32_t> point_slots_;  // index into points_ by the point's number, or kGone
  std::vector<std::uint32_t> free_point_slots_;
  BlockList<std::vector<Observation>> offline_observations_;  // by online keyframes, per offline point
  Shared<std::map<Observation, PointId>> points_of_foreign_views_;
  // Ascending by keyframe; only points with foreign views.
  Shared<std::map<PointId, std::vector<ForeignView>>> foreign_views_;
  int keyframe_count_ = 0;
  int point_count_ = 0;
};

// Describes every violated invariant. Empty for a valid map.
std::vector<std::string> find_faults(const MapGraph& map);

// Rig of a keyframe of the map.
inline const Rig& rig_of(const MapGraph& map, const Keyframe& keyframe) {
  return map.rigs()[static_cast<std::size_t>(keyframe.rig)];
}

}  // namespace byre
