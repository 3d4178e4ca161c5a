#pragma once

#include "byre/features.h"
#include "byre/geometry/rectified_change.h"
#include "byre/input_error.h"
#include "byre/map/block_list.h"
#include "byre/map/ids.h"
#include "byre/workers/reused_memory.h"

#include <cassert>
#include <cstdint>
#include <functional>
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
  // Covariance of the position, square metres. In double: rounded to float it may no longer be positive definite.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector3f mean_viewing_direction = Eigen::Vector3f::UnitZ();  // unit length, camera to point
  Descriptor descriptor{};                                            // the most central of its observations'
  float min_distance = 0.0f;                                          // metres over which the descriptor holds
  float max_distance = 0.0f;
  Observation reference;  // the view whose patch defines the point in the image
};

// A point or none, in a third of the memory of what it stands for: there is one for each feature of each keyframe.
class OptionalPoint {
 public:
  OptionalPoint() = default;
  OptionalPoint(std::nullopt_t) {}
  // Precondition: a number below 2^31 - 1.
  OptionalPoint(PointId id) : bits_(id.number << 1U | static_cast<std::uint32_t>(id.origin)) {
    assert(id.number < kNone >> 1U);
  }
  OptionalPoint(const std::optional<PointId>& id) : OptionalPoint(id ? OptionalPoint(*id) : OptionalPoint()) {}

  bool has_value() const { return bits_ != kNone; }
  explicit operator bool() const { return has_value(); }
  operator std::optional<PointId>() const { return has_value() ? std::optional(**this) : std::nullopt; }
  // Preconditions: has_value().
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

  std::uint32_t bits_ = kNone;  // the number, and the origin as the lowest bit
};

// What a keyframe's feature has measured of a point: the keypoint, refined in the image against the point's reference.
struct Sighting {
  OptionalPoint point;                              // a point of this map or an offline one
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  // full-resolution pixels
  float pixel_sigma = 1.0f;                         // pixels
};

// What a keyframe saw, and the same as another calibration of the camera has it.
struct RecalibratedFeatures {
  KeyframeId keyframe;
  std::shared_ptr<const Features> before;
  std::shared_ptr<const Features> after;
};

// A point of the online map as a keyframe of the offline one sees it, which is never to know of it.
struct ForeignView {
  Observation observation;  // a keyframe of the other map and its feature
  Sighting sighting;        // what the feature has measured of a point of this map
};

// A point with the observations of it by keyframes of its map, ascending.
struct ObservedPoint {
  MapPoint point;
  std::vector<Observation> observations;
};

using Word = std::uint32_t;  // a visual word of a vocabulary, see place/vocabulary.h

struct Keyframe {
  Frame frame;
  int rig = 0;        // index into Map::rigs()
  int recording = 0;  // which of the recordings the map was made from, see StoredMap
  Pose camera_from_world;
  // Covariance of delta in exp_pose(delta) * camera_from_world, relative to the map's origin.
  Matrix6 covariance = Matrix6::Zero();
  std::vector<Sighting> sightings;   // one per feature
  std::optional<KeyframeId> parent;  // the keyframe of the same map it was tracked from; empty for the first
  std::vector<Word> words;           // one per feature, or none while they are not known
};

// Where a removed keyframe was: a fixed pose relative to its parent, so that frames tracked from it keep theirs.
struct RemovedKeyframe {
  int rig = 0;  // index into Map::rigs()
  KeyframeId parent;
  Pose camera_from_parent;
};

// What a map is made of; a keyframe's or point's place in its list is its number.
struct MapParts {
  std::vector<Rig> rigs;
  std::vector<Keyframe> keyframes;
  std::vector<MapPoint> points;
};

// A keyframe that sees some of the same points.
struct Covisible {
  KeyframeId keyframe;
  int shared_points = 0;
};

// The parts of a map that stay in its file until they are accessed. Several threads may access at once. References stay
// valid as long as the source does. Where the file is damaged, damage() is set and the part is replaced: a keyframe by
// one that sees no point, points by points that no keyframe sees.
class MapSource {
 public:
  using WordVisitor = std::function<void(KeyframeId, std::span<const Word>)>;

  virtual ~MapSource() = default;
  // bare: the same without what it sees.
  virtual const Keyframe& keyframe(std::uint32_t number, const Keyframe& bare) const = 0;
  virtual const ObservedPoint& point(std::uint32_t number) const = 0;
  virtual ReusedVector<Covisible> covisible(std::uint32_t number) const = 0;  // ascending by keyframe
  // Like Map::visit_words. Throws InputError if the words are damaged.
  virtual void visit_words(const WordVisitor& visit) const = 0;
  // The first damage found on access, with file, section and remedy; nullptr without damage.
  virtual const InputError* damage() const = 0;
};

// A plain value: copy it, change the copy, save it. Keeps both ends of every observation in step.
// Dense containers indexed by id number; numbers are never used twice. Ids handed in must be of this map's origin
// unless said otherwise. A look-up of a removed or foreign thing gives nullptr, and a change to one does nothing.
// Pointers and references handed out are valid until the next change. Several threads may look at a map at once, while
// none changes it.
//
// A map with a source reads sightings and points from it on first access and keeps them. damage() reports a damaged
// source. The first change reads the whole source, and throws InputError if it is damaged.
class Map {
 public:
  explicit Map(Origin origin) : origin_(origin) {}
  // All at once, which is many times faster than one by one. Preconditions: keyframes have a sighting per feature, see
  // no point twice, and come after their parents; ids are of this origin and within the parts.
  Map(Origin origin, MapParts parts);
  // A map of the origin offline. Keyframes are bare: without features, sightings and words.
  Map(std::vector<Rig> rigs, std::vector<Keyframe> bare, int point_count, std::shared_ptr<const MapSource> source);

  Origin origin() const { return origin_; }

  int add_rig(const Rig& rig);  // index of the rig; an equal one is not stored twice
  const std::vector<Rig>& rigs() const { return rigs_; }

  // Adds the keyframe with the observations its sightings name. Points that are gone, and second sightings of the same
  // point, are dropped from the sightings; missing sightings are filled up with empty ones. A parent that was removed
  // is replaced by its own parent, one that never was in this map is dropped.
  KeyframeId add_keyframe(Keyframe keyframe);
  PointId add_point(const MapPoint& point);

  // The feature's sighting becomes this one. Does nothing (false) when keyframe or point is gone, the feature already
  // sees a point, or the keyframe already sees this point. An offline point may be seen by an online keyframe.
  bool add_observation(const Observation& observation, const Sighting& sighting);
  // A point left without observations goes too; one that loses its reference gets its lowest observation instead.
  void remove_observation(const Observation& observation);

  // An offline keyframe sees the point that the sighting names. Kept apart from observations(): it goes with its point,
  // keeps none alive, defines none, and counts for no covisibility. Does nothing (false) when the point is gone, the
  // keyframe is not offline, the feature already sees a point of this map, or the keyframe already sees this point.
  // Precondition: the feature sees no point of its own map.
  bool add_foreign_view(const ForeignView& view);
  void remove_foreign_view(const Observation& observation);

  void remove_point(PointId id);
  // Its children are handed to its parent, and its pose is kept relative to it. A keyframe without a parent stays:
  // the poses of the others hang from it.
  void remove_keyframe(KeyframeId id);

  // For a map that is used up keyframe by keyframe: what it sees is no longer there, but all points are. Precondition:
  // it is there.
  Keyframe take_keyframe(KeyframeId id);

  void set_words(KeyframeId id, std::vector<Word> words);
  void move_keyframe(KeyframeId id, const Pose& camera_from_world, const Matrix6& covariance);
  // What was seen through a rig, as another calibration of the same camera has it: features, sightings and poses of its
  // keyframes, and the rig itself. Points stay where they are. made: features of some of these keyframes, ascending,
  // made beforehand; they are taken where the keyframe still has those before.
  void recalibrate(int rig, const RectifiedChange& change, std::span<const RecalibratedFeatures> made);
  // What a keyframe saw, found to lie a little elsewhere in the image; its sightings move along. Points stay where they
  // are. Precondition: the keyframe's own features, moved.
  void move_features(KeyframeId id, Features moved);
  // What a keyframe saw is kept elsewhere. Precondition: the keyframe's own features, or equal ones.
  void replace_features(KeyframeId id, std::shared_ptr<const Features> equal);
  // The keyframe forgets the patches of other features. Precondition: indices, ascending.
  void keep_patches(KeyframeId id, std::span<const int> features);
  int rig_of(KeyframeId id) const;  // index into rigs(), of a removed keyframe too. Precondition: was once given out
  // Where a removed keyframe lies relative to its parent, with lengths times the scale. Nothing for one still there.
  void scale_removed_keyframe(KeyframeId id, double scale);
  // A reference that does not observe the point is replaced by the point's lowest observation.
  void update_point(PointId id, const MapPoint& point);

  const Keyframe* find_keyframe(KeyframeId id) const;
  // The same for who looks neither at features nor at sightings and words, which are missing where a source has them.
  const Keyframe* find_bare_keyframe(KeyframeId id) const;
  const MapPoint* find_point(PointId id) const;
  std::vector<KeyframeId> keyframe_ids() const;  // ascending
  std::vector<PointId> point_ids() const;        // ascending
  // Calls visit with the words of each keyframe, none where they are not known, ascending by keyframe.
  void visit_words(const MapSource::WordVisitor& visit) const;
  // See MapSource; nullptr without a source.
  const InputError* damage() const { return source_ ? source_->damage() : nullptr; }
  int keyframe_count() const { return keyframe_count_; }
  int point_count() const { return point_count_; }

  // Observations of a point, offline ones too, by this map's keyframes, ascending. Empty for an unknown point.
  const std::vector<Observation>& observations(PointId id) const;
  // Foreign views of one of this map's points, ascending by keyframe. Empty for an unknown or offline point.
  const std::vector<ForeignView>& foreign_views(PointId id) const;
  // The features by which an offline keyframe sees points of this map, ascending.
  std::vector<Observation> foreign_observations(KeyframeId offline) const;
  // The point of this map that an offline keyframe's feature sees.
  std::optional<PointId> point_of_foreign_view(const Observation& observation) const;

  // Keyframes that share points with this one, most shared first (ties: lower id first); maintained, not computed.
  ReusedVector<Covisible> covisible_keyframes(KeyframeId id, int max_count) const;

  // The pose of a keyframe now, also of a removed one, through its parents. Precondition: the id was once given out.
  Pose camera_from_world(KeyframeId id) const;
  // The keyframe itself while it is there, else the first of its parents that is; empty for an id never given out.
  std::optional<KeyframeId> living_ancestor(std::optional<KeyframeId> id) const;

 private:
  struct KeyframeSlot {
    std::optional<Keyframe> keyframe;
    std::optional<RemovedKeyframe> removed;
    std::vector<Covisible> covisible;  // ascending by keyframe
    std::vector<KeyframeId> children;  // ascending
  };

  static constexpr std::uint32_t kGone = 0xFFFFFFFF;  // in place of a place in points_

  bool was_given_out(KeyframeId id) const;
  Keyframe* find_own_keyframe(KeyframeId id);
  KeyframeSlot& slot(KeyframeId id) { return keyframes_[id.number]; }
  const KeyframeSlot& slot(KeyframeId id) const { return keyframes_[id.number]; }
  // nullptr for a point that is gone, and for one of another origin.
  const ObservedPoint* find_observed(PointId id) const;
  // The same, and nullptr for one that a source has.
  const ObservedPoint* find_slot(PointId id) const;
  ObservedPoint& slot(PointId id) { return points_[place_of_point_[id.number]]; }  // precondition: it is there
  // Where the observations of a point are kept, of an offline point too; nullptr for one that is gone.
  std::vector<Observation>* find_observations(PointId id);

  // Takes the observation out at both ends and returns its point, whose slot stays even when nothing is left in it.
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
  void hand_children_to(KeyframeId id, KeyframeId parent);

  Origin origin_;
  std::vector<Rig> rigs_;
  std::shared_ptr<const MapSource> source_;  // nullptr when all is here
  std::vector<KeyframeSlot> keyframes_;      // bare ones with a source
  // Points that are there, in any order, and empty places: most of the points that ever were do not last, and shall
  // not take up room for good.
  BlockList<ObservedPoint> points_;
  std::vector<std::uint32_t> place_of_point_;  // place in points_ by the point's number, or kGone
  std::vector<std::uint32_t> empty_places_;
  std::vector<std::vector<Observation>> offline_observations_;  // observations by online keyframes, per offline point
  std::map<Observation, PointId> points_of_foreign_views_;
  std::map<PointId, std::vector<ForeignView>> foreign_views_;  // ascending by keyframe; only points that have some
  int keyframe_count_ = 0;
  int point_count_ = 0;
};

// Every broken invariant, in words. Empty for a sound map.
std::vector<std::string> find_faults(const Map& map);

}  // namespace byre
