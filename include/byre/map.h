#pragma once

#include "byre/calibration.h"
#include "byre/features.h"
#include "byre/image.h"
#include "byre/localisation_failure.h"
#include "byre/plan_registration.h"
#include "byre/rig.h"
#include "byre/tag.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace byre {

struct StoredMap;

// Recording that a map was made from.
struct MapRecording {
  std::string name;
  Calibration calibration;  // with all refinements
  Timestamp first_time{};   // time of its first frame, keyframe or not
  Timestamp last_time{};
};

// Keyframe of a map. Its features are the corners that measure a map point; pixels and points have one item for each.
struct MapKeyframe {
  int id = 0;
  Timestamp time{};
  int recording = 0;          // index into Map::recordings()
  std::optional<int> parent;  // keyframe from which it was tracked; empty for the first one
  Pose map_from_body;
  Pose map_from_camera;                  // rectified left camera
  Matrix6 covariance = Matrix6::Zero();  // covariance of delta in map_from_body * exp_pose(delta)
  Rig rig;                               // rectified camera of all pixels
  std::shared_ptr<const Features> features;
  std::vector<Eigen::Vector2f> pixels;  // measurement of the point, refined against its patch; pixels of rig
  std::vector<int> points;              // id of the point; -1 without one
};

// Measurement of a point by a keyframe.
struct MapObservation {
  int keyframe = 0;
  int feature = 0;                                  // index into MapKeyframe::features
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  // pixels of MapKeyframe::rig
  float sigma = 1.0f;                               // pixels, of column and of row
};

// Keyframes and points that only one of two maps has at their exact position. Updates, cuts and merges do not move
// those that remain. Ids, ascending.
struct MapDifference {
  std::vector<int> removed_keyframes;  // in the map before
  std::vector<int> removed_points;
  std::vector<int> added_keyframes;  // in the map after
  std::vector<int> added_points;
};

// An update that a map was made by.
struct MapHistory {
  std::uint64_t parent = 0;  // content hash of the map file that was updated, as in `byre history`
  std::string change;        // "evening, night: 31 keyframes and 904 points added, 12 points retired (byre 0.1.0)"
};

// A saved map: keyframes, points and their observations. An immutable value whose copies share memory, so any number of
// threads may read it. Edits return another map. Keyframes and points are numbered from 0 without gaps; an edit that
// removes some renumbers the others. Map frame: that of the first keyframe's body, unless transformed. Lengths are
// metres if is_metric(), else an arbitrary unit. Precondition of all functions: ids of keyframes, points and recordings
// exist.
class Map {
 public:
  // Throws InputError naming section and byte for a missing or damaged file and for another format.
  static Map load(const std::filesystem::path& path);
  // Replaces the file atomically. Throws InputError if it cannot be written, or exists and is no map.
  void save(const std::filesystem::path& path) const;
  // Content of a map file. name: used in messages of InputError, thrown as by load().
  static Map from_bytes(std::span<const std::byte> bytes, const std::string& name);
  std::vector<std::byte> to_bytes() const;

  int keyframes() const;
  int points() const;
  int observations() const;
  bool is_metric() const;
  std::string summary() const;  // "13 keyframes, 2043 points, 1 recording, metric"
  std::vector<MapRecording> recordings() const;
  const std::map<std::string, std::string>& notes() const;  // text by key, such as "site"
  const std::optional<PlanRegistration>& plan() const;      // registration on a floor plan
  std::vector<MappedTag> tags() const;                      // AprilTags, by id
  std::vector<MapHistory> history() const;                  // updates that the map was made by, the newest first
  MapDifference difference(const Map& after) const;

  MapKeyframe keyframe(int id) const;
  // Small grey picture of a keyframe's left image, as rectified; pixel x is at (x + 0.5) * rig.width / width - 0.5 of
  // the rig. Empty without one. Throws InputError if it is no JPEG file.
  std::optional<Image> picture(int keyframe) const;
  // map_from_body of the keyframes of a recording, by time.
  Trajectory trajectory(int recording) const;

  const Eigen::Vector3d& position(int point) const;    // in the map
  const Eigen::Matrix3d& covariance(int point) const;  // covariance of the position, squared lengths
  // Grey value of the image at the point, 0 to 255; empty if its patch was not kept.
  std::optional<std::uint8_t> grey(int point) const;
  std::vector<MapObservation> observations(int point) const;  // ascending by keyframe
  // The same for all points, by id.
  std::vector<Eigen::Vector3d> positions() const;
  std::vector<Eigen::Matrix3d> covariances() const;
  std::vector<int> observation_counts() const;
  // Number of recordings that observe each point: points of several visits are of lasting structure.
  std::vector<int> recording_counts() const;

  // Points inside the image of a recording's rectified camera and at most max_distance from it, ascending. Hidden
  // points are included.
  std::vector<int> points_in_view(const Pose& map_from_body, double max_distance, int recording = 0) const;
  // Nearest points of a place, nearest first; fewer than count if the map has fewer.
  std::vector<int> nearest_points(const Eigen::Vector3d& place_in_map, int count) const;
  std::vector<int> points_in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;  // ascending
  std::vector<int> points_in_sphere(const Eigen::Vector3d& centre_in_map, double radius) const;   // ascending
  // Points whose position on the floor plan is inside a polygon with these corners, at any height; ascending. Throws
  // InputError if the map is not registered on a plan.
  std::vector<int> points_in_polygon(std::span<const Eigen::Vector2d> corners_in_plan) const;
  // Keyframes whose camera is at most radius from a place, nearest first.
  std::vector<int> keyframes_near(const Eigen::Vector3d& place_in_map, double radius) const;

  // Copy without these points and their observations. Keyframes that observe no other point are removed too, except
  // those without a parent. Unknown ids are ignored.
  Map without_points(std::span<const int> points) const;
  // Copy in another frame, with scaled lengths and baselines. Covariances and the registration on a plan are adapted.
  // Throws InputError unless the scale is positive and all numbers are finite.
  Map transformed(const Similarity& target_from_map) const;
  // Merged with a map that overlaps, as by `byre merge`: in the frame and on the plan of this one. Keyframes keep their
  // numbers, those of the other follow. vocabulary: file of the words; empty: the installed one. Throws InputError with
  // the reason if the maps do not overlap, or a similar building is likelier. Takes seconds for hundreds of keyframes.
  Map merged_with(const Map& other, const std::optional<std::filesystem::path>& vocabulary = {}) const;

  // Fits the map to points picked on a floor plan, with the scale if the map is not metric. plan: name of the plan.
  // Throws InputError if the picks do not determine the registration: fewer than two separate ones, or a map without
  // keyframes that stay upright.
  PlanFit register_on_plan(const std::string& plan, std::span<const PlanCorrespondence> picks,
                           const PlanRegistrationOptions& options = {}) const;
  // Copy with this registration. Throws InputError if residual_of(fit) is larger, metres.
  Map with_plan(const PlanFit& fit, double accepted_residual = kLargePlanResidual) const;
  // Copy with the tags added that are surveyed with a heading and that the map does not have. Their heights are right
  // if the map was registered by the height of its body (PlanRegistrationOptions). Throws InputError if the map is not
  // registered on a plan.
  Map with_tags(std::span<const Tag> surveyed) const;

  // Internals for the programs of byre; their type is not public.
  explicit Map(StoredMap stored);
  const StoredMap& stored() const { return *stored_; }

 private:
  std::shared_ptr<const StoredMap> stored_;
};

// Result of localising an image.
struct LocalisationReport {
  std::optional<Pose> map_from_body;                        // empty if the image was not localised
  Matrix6 covariance = Matrix6::Zero();                     // covariance of delta in map_from_body * exp_pose(delta)
  int inliers = 0;                                          // map points that fit the pose, or of the last step reached
  LocalisationFailure failure = LocalisationFailure::none;  // reason if there is no pose
};

// Localises images of one camera in a map, each without a prediction. AprilTags of the map decide between places that
// look alike. Construction takes some tenths of a second, an image some hundredths of a second. Not thread-safe.
class Localiser {
 public:
  // calibration: cameras of the images; empty: those of the map's newest recording. A refinement stored in the map is
  // applied. vocabulary: file of the words; empty: the installed one. Throws InputError for a map without keyframes, a
  // calibration that cannot be rectified, and a vocabulary that cannot be loaded.
  explicit Localiser(const Map& map, const std::optional<Calibration>& calibration = {},
                     const std::optional<std::filesystem::path>& vocabulary = {});
  Localiser(Localiser&&) noexcept;
  Localiser& operator=(Localiser&&) noexcept;
  ~Localiser();

  // The images are borrowed for the call. Right and depth image are optional, and unused in a map that is not metric.
  // Throws InputError if an image differs from the calibration in size or kind.
  LocalisationReport localise(const CameraImages& images);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// What an update of a map changed, or why there is none.
struct MapUpdateResult {
  std::string refusal{};  // empty: the updated map was written
  int keyframes_added = 0;
  int points_added = 0;
  int points_retired = 0;
};

// Updates a map by sessions of missions on it, as `byre update`: writes the new version to `output`, which must not be
// `map`, unless no session fits or a place would be worse. vocabulary: file of the words; empty: the installed one.
// Takes seconds. Throws InputError if a file cannot be read or written, or is not of its kind.
MapUpdateResult update_map_file(const std::filesystem::path& map, std::span<const std::filesystem::path> sessions,
                                const std::filesystem::path& output,
                                const std::optional<std::filesystem::path>& vocabulary = {});

}  // namespace byre
