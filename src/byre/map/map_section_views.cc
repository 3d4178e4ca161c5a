// Reads keypoints, descriptors, patches and measurements of keyframes, rounded to quanta.

#include "byre/base/task_threads.h"
#include "byre/input_error.h"
#include "byre/map/descriptor_difference.h"
#include "byre/map/map_numbers.h"
#include "byre/map/map_quanta.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"
#include "byre/map/map_view_layout.h"
#include "byre/map/packed_steps.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace byre {
namespace {

float read_coordinate(ByteReader& reader, int size) {
  const auto code = static_cast<std::uint32_t>(reader.read_low_bytes(bytes_for_pixels(size)));
  if (code >= pixel_codes(size)) reader.fail("has a keypoint outside its image");
  return coordinate_of(code);
}

void read_disparity(ByteReader& reader, Keypoint& keypoint) {
  keypoint.disparity = float_of_24(static_cast<std::uint32_t>(reader.read_low_bytes(kDisparityBytes)));
  keypoint.disparity_sigma = sigma_of_code(reader.read<std::uint8_t>());
  if (!(keypoint.disparity > 0.0f)) reader.fail("has a disparity that is not positive");
}

// Keypoints of one keyframe, with the first byte of each.
struct ReadKeypoints {
  std::vector<Keypoint> keypoints;
  std::vector<std::uint8_t> bits;
};

ReadKeypoints read_keypoints(ByteReader& reader, const Rig& rig, std::size_t keyframe) {
  ReadKeypoints read;
  read.keypoints.resize(reader.read_count(kLeastKeypointBytes));
  read.bits.reserve(read.keypoints.size());
  for (Keypoint& keypoint : read.keypoints) {
    const auto bits = read.bits.emplace_back(reader.read<std::uint8_t>());
    if ((bits & ~kAllBits) != 0) reader.fail("has a keypoint of an unknown kind");
    keypoint.octave = bits & kOctaveBits;
    keypoint.pixel.x() = read_coordinate(reader, rig.width);
    keypoint.pixel.y() = read_coordinate(reader, rig.height);
    if ((bits & kHasDisparity) != 0) read_disparity(reader, keypoint);
    require_no_fault(reader, fault_in(keypoint, rig), "keyframe", keyframe);
  }
  return read;
}

float read_offset(ByteReader& reader) {
  const std::uint32_t code = reader.read_varint();
  if (code > kLargestOffsetCode) reader.fail("has a sighting far from its keypoint");
  return offset_of(code);
}

Sighting read_sighting(ByteReader& reader, const Keypoint& keypoint, std::uint32_t keyframe, std::size_t point_count) {
  const auto point = static_cast<std::uint32_t>(reader.read_low_bytes(bytes_for(point_count)));
  if (point >= point_count) {
    reader.fail("refers to point " + std::to_string(point) + " of " + std::to_string(point_count));
  }
  const float u = read_offset(reader);
  const float v = read_offset(reader);
  const float sigma = sigma_of_code(reader.read<std::uint8_t>());
  const Sighting sighting{PointId{Origin::offline, point}, keypoint.pixel + Eigen::Vector2f(u, v), sigma};
  require_no_fault(reader, fault_in(sighting), "keyframe", keyframe);
  return sighting;
}

// Calls check(point, feature) for each sighting.
template <typename Check>
std::vector<Sighting> read_sightings(ByteReader& reader, const ReadKeypoints& of, std::uint32_t keyframe,
                                     std::size_t point_count, Check check) {
  std::vector<Sighting> sightings(of.keypoints.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if ((of.bits[i] & kSeesPoint) == 0) continue;
    sightings[i] = read_sighting(reader, of.keypoints[i], keyframe, point_count);
    check(sightings[i].point->number, static_cast<int>(i));
  }
  return sightings;
}

// descriptor_of(number) returns the descriptor of a point.
template <typename DescriptorOf>
std::vector<Descriptor> read_descriptors(ByteReader& reader, const std::vector<Sighting>& sightings,
                                         DescriptorOf descriptor_of) {
  std::vector<Descriptor> descriptors(sightings.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const std::optional<PointId>& point = sightings[i].point;
    if (point) {
      descriptors[i] = read_difference(reader, descriptor_of(point->number));
    } else {
      reader.read_all<std::uint64_t>(descriptors[i]);
    }
  }
  return descriptors;
}

Patch read_patch(ByteReader& reader, std::size_t keyframe) {
  PatchCode code;
  code.darkest = reader.read<std::uint8_t>();
  code.brightest = reader.read<std::uint8_t>();
  reader.read_all<std::uint16_t>(code.centre);
  code.steps = read_packed_steps(reader);
  const std::optional<Patch> patch = patch_of(code);
  require_no_fault(reader, patch ? fault_in(*patch) : "has an invalid patch", "keyframe", keyframe);
  return *patch;
}

struct KeptPatches {
  std::vector<Patch> patches;
  std::vector<int> patch_of_keypoint;  // -1: none
};

KeptPatches read_patches(ViewSections& sections, const std::vector<std::uint8_t>& bits, std::size_t keyframe) {
  KeptPatches kept;
  kept.patch_of_keypoint.assign(bits.size(), -1);
  kept.patches.reserve(
      static_cast<std::size_t>(std::ranges::count_if(bits, [](std::uint8_t each) { return (each & kHasPatch) != 0; })));
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if ((bits[i] & kHasPatch) == 0) continue;
    kept.patch_of_keypoint[i] = static_cast<int>(kept.patches.size());
    kept.patches.push_back(read_patch(sections.patches, keyframe));
  }
  return kept;
}

// Data of a keyframe without its descriptors.
struct PartOfView {
  ReadKeypoints keypoints;
  KeptPatches patches;
};

std::shared_ptr<const Features> features_of_view(const ByteReader& reader, PartOfView part,
                                                 std::vector<Descriptor> descriptors, const Rig& rig,
                                                 std::uint32_t keyframe) {
  const std::vector<Keypoint>& keypoints = part.keypoints.keypoints;
  auto features =
      std::make_shared<const Features>(rig.width, rig.height, keypoints, std::move(descriptors),
                                       std::move(part.patches.patches), std::move(part.patches.patch_of_keypoint));
  if (!std::ranges::equal(features->keypoints(), keypoints, {}, &Keypoint::pixel, &Keypoint::pixel)) {
    require_no_fault(reader, "has keypoints that are not sorted by grid cell", "keyframe", keyframe);
  }
  return features;
}

// Remaining bytes of all sections except words, which are separate.
ViewSizes remaining(const ViewSections& sections) {
  ViewSizes sizes{};
  sizes[kFeaturesOfView] = static_cast<std::uint32_t>(sections.features.remaining());
  sizes[kPatchesOfView] = static_cast<std::uint32_t>(sections.patches.remaining());
  sizes[kObservationsOfView] = static_cast<std::uint32_t>(sections.observations.remaining());
  sizes[kDescriptorsOfView] = static_cast<std::uint32_t>(sections.descriptors.remaining());
  return sizes;
}

// Checks observations while sightings are read keyframe by keyframe. Fails for a point with two observations by one
// keyframe, and at the end for a point without observations.
class PointObservers {
 public:
  explicit PointObservers(std::size_t point_count) : last_observer_(point_count, kNoObserver) {}

  std::size_t point_count() const { return last_observer_.size(); }

  // Precondition: point < point_count().
  void add(const ByteReader& reader, std::uint32_t point, std::uint32_t keyframe) {
    if (last_observer_[point] == keyframe) require_no_fault(reader, "is observed twice by a keyframe", "point", point);
    last_observer_[point] = keyframe;
  }

  void require_all_observed(const ByteReader& reader) const {
    for (std::size_t point = 0; point < last_observer_.size(); ++point) {
      if (last_observer_[point] == kNoObserver)
        require_no_fault(reader, "is not observed by any keyframe", "point", point);
    }
  }

 private:
  static constexpr auto kNoObserver = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> last_observer_;  // number of the last keyframe that observes each point
};

// Reads keyframes' features and sightings from sections with one part per keyframe.
class ViewReader {
 public:
  ViewReader(ViewSections sections, const std::vector<MapPoint>& points)
      : sections_(std::move(sections)), points_(points), observers_(points.size()) {}

  void read(std::uint32_t number, const Rig& rig, Keyframe& keyframe, ViewSizes& sizes) {
    const ViewSizes before = remaining(sections_);
    PartOfView part{read_keypoints(sections_.features, rig, number), {}};
    keyframe.sightings = read_observed(part.keypoints, number);
    std::vector<Descriptor> descriptors =
        read_descriptors(sections_.descriptors, keyframe.sightings,
                         [this](std::uint32_t point) -> const Descriptor& { return points_[point].descriptor; });
    part.patches = read_patches(sections_, part.keypoints.bits, number);
    keyframe.frame.features =
        features_of_view(sections_.features, std::move(part), std::move(descriptors), rig, number);
    set_taken(before, remaining(sections_), sizes);
  }

  // Without descriptors.
  PartOfView read_part(std::uint32_t number, const Rig& rig, Keyframe& keyframe) {
    PartOfView part{read_keypoints(sections_.features, rig, number), {}};
    keyframe.sightings = read_observed(part.keypoints, number);
    part.patches = read_patches(sections_, part.keypoints.bits, number);
    return part;
  }

  void require_end() const {
    for (const ByteReader* const section :
         {&sections_.features, &sections_.patches, &sections_.observations, &sections_.descriptors}) {
      section->require_end();
    }
    observers_.require_all_observed(sections_.observations);
  }

 private:
  std::vector<Sighting> read_observed(const ReadKeypoints& of, std::uint32_t number) {
    return read_sightings(sections_.observations, of, number, observers_.point_count(),
                          [&](std::uint32_t point, int) { observers_.add(sections_.observations, point, number); });
  }

  ViewSections sections_;
  const std::vector<MapPoint>& points_;
  PointObservers observers_;
};

// Skips features of a keyframe without checking values. Calls visit for each with its point, or nullptr.
template <typename Visitor>
void skip_view(std::uint32_t count, const Rig& rig, std::size_t point_bytes, ViewSections& sections, Visitor visit) {
  const std::size_t pixel_bytes = bytes_for_pixels(rig.width) + bytes_for_pixels(rig.height);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto bits = sections.features.read<std::uint8_t>();
    sections.features.take(pixel_bytes + ((bits & kHasDisparity) != 0 ? kDisparityBytes + 1 : 0));
    if ((bits & kHasPatch) != 0) {
      sections.patches.take(kPatchHeadBytes);
      skip_packed_steps(sections.patches);
    }
    if ((bits & kSeesPoint) == 0) {
      visit(nullptr);
      continue;
    }
    const auto point = static_cast<std::uint32_t>(sections.observations.read_low_bytes(point_bytes));
    for (int offset = 0; offset < 2; ++offset) sections.observations.skip_varint();
    sections.observations.take(1);
    visit(&point);
  }
}

// Multi-threaded ViewReader: one thread reads all descriptors, whose code has variable length; the others read runs of
// consecutive keyframes, located first. Throws InputError for any error, but not always that of ViewReader.
class ViewsReader {
 public:
  ViewsReader(const ViewSections& sections, const std::vector<MapPoint>& points, const std::vector<Rig>& rigs,
              std::vector<Keyframe>& keyframes, PartSizes& sizes)
      : sections_(sections),
        points_(points),
        rigs_(rigs),
        keyframes_(keyframes),
        sizes_(sizes.views),
        parts_(keyframes.size()),
        descriptors_(keyframes.size()) {}

  void read(int thread_count) {
    TaskThreads threads(thread_count - 1);
    length_of_runs_ =
        std::max(kShortestRun, keyframes_.size() / (kRunsOfThread * static_cast<std::size_t>(thread_count)));
    find_runs();
    const auto runs = static_cast<int>(runs_.size());
    threads.run(1 + runs, [this](int task) {
      if (task == 0) return read_all_descriptors();
      read_run(static_cast<std::size_t>(task - 1));
    });
    threads.run(runs, [this](int run) { make_features(static_cast<std::size_t>(run)); });
  }

 private:
  static constexpr std::size_t kShortestRun = 16;  // number of keyframes
  static constexpr std::size_t kRunsOfThread = 8;

  const Rig& rig_of(std::size_t keyframe) const { return rigs_[static_cast<std::size_t>(keyframes_[keyframe].rig)]; }
  std::size_t end_of(std::size_t run) const { return std::min(length_of_runs_ * (run + 1), keyframes_.size()); }

  void find_runs() {
    ViewSections rest = sections_;
    for (std::size_t i = 0; i < keyframes_.size(); ++i) {
      if (i % length_of_runs_ == 0) runs_.push_back(rest);
      const ViewSizes before = remaining(rest);
      const std::uint32_t count = rest.features.read_count(kLeastKeypointBytes);
      skip_view(count, rig_of(i), bytes_for(points_.size()), rest, [](const std::uint32_t*) {});
      set_taken(before, remaining(rest), sizes_[i]);
    }
    rest.features.require_end();
    rest.patches.require_end();
    rest.observations.require_end();
  }

  void read_run(std::size_t run) {
    ViewReader reader(runs_[run], points_);
    for (std::size_t i = length_of_runs_ * run; i < end_of(run); ++i) {
      parts_[i] = reader.read_part(static_cast<std::uint32_t>(i), rig_of(i), keyframes_[i]);
    }
  }

  void read_all_descriptors() {
    ViewSections rest = sections_;
    ByteReader& reader = rest.descriptors;
    for (std::size_t i = 0; i < keyframes_.size(); ++i) {
      std::vector<Descriptor>& descriptors = descriptors_[i];
      const std::uint32_t count = rest.features.read_count(kLeastKeypointBytes);
      descriptors.reserve(count);
      const std::size_t before = reader.remaining();
      skip_view(count, rig_of(i), bytes_for(points_.size()), rest, [&](const std::uint32_t* point) {
        if (point == nullptr) {
          reader.read_all<std::uint64_t>(descriptors.emplace_back());
        } else if (*point < points_.size()) {
          descriptors.push_back(read_difference(reader, points_[*point].descriptor));
        } else {
          reader.fail("belongs to an invalid point");
        }
      });
      sizes_[i][kDescriptorsOfView] = static_cast<std::uint32_t>(before - reader.remaining());
    }
    reader.require_end();
  }

  void make_features(std::size_t run) {
    for (std::size_t i = length_of_runs_ * run; i < end_of(run); ++i) {
      keyframes_[i].frame.features =
          features_of_view(sections_.features, std::exchange(parts_[i], {}), std::exchange(descriptors_[i], {}),
                           rig_of(i), static_cast<std::uint32_t>(i));
    }
  }

  const ViewSections& sections_;
  const std::vector<MapPoint>& points_;
  const std::vector<Rig>& rigs_;
  std::vector<Keyframe>& keyframes_;
  std::vector<ViewSizes>& sizes_;
  std::size_t length_of_runs_ = kShortestRun;  // number of keyframes
  std::vector<ViewSections> runs_;             // start of each run; descriptors at their beginning
  std::vector<PartOfView> parts_;
  std::vector<std::vector<Descriptor>> descriptors_;
};

void read_views_in_order(const ViewSections& sections, const std::vector<MapPoint>& points,
                         const std::vector<Rig>& rigs, std::vector<Keyframe>& keyframes, PartSizes& sizes) {
  ViewReader reader(sections, points);
  for (std::uint32_t i = 0; i < keyframes.size(); ++i) {
    reader.read(i, rigs[static_cast<std::size_t>(keyframes[i].rig)], keyframes[i], sizes.views[i]);
  }
  reader.require_end();
}

// False if there are too few keyframes or threads, or on an error.
bool try_to_read_views(const ViewSections& sections, const std::vector<MapPoint>& points, const std::vector<Rig>& rigs,
                       std::vector<Keyframe>& keyframes, PartSizes& sizes) {
  constexpr std::size_t kWorthThreads = 256;  // number of keyframes
  constexpr int kMostThreads = 8;
  const int threads = std::min(processor_count(), kMostThreads);
  if (threads < 2 || keyframes.size() < kWorthThreads) return false;
  try {
    ViewsReader(sections, points, rigs, keyframes, sizes).read(threads);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// Each reference is one of the point's observations, which are in the order of keyframes.
void set_references(const ByteReader& reader, const std::vector<Keyframe>& keyframes, RoundedPoints& points) {
  std::vector<std::uint32_t> left = points.references;  // number of observations before the reference
  std::vector<bool> is_set(points.points.size(), false);
  for (std::uint32_t number = 0; number < keyframes.size(); ++number) {
    const std::vector<Sighting>& sightings = keyframes[number].sightings;
    for (std::size_t feature = 0; feature < sightings.size(); ++feature) {
      if (!sightings[feature].point) continue;
      const std::uint32_t point = sightings[feature].point->number;
      if (is_set[point] || left[point]-- > 0) continue;
      points.points[point].reference = {{Origin::offline, number}, static_cast<int>(feature)};
      is_set[point] = true;
    }
  }
  for (std::size_t point = 0; point < is_set.size(); ++point) {
    if (!is_set[point]) require_no_fault(reader, "has a reference keyframe that does not observe it", "point", point);
  }
}

}  // namespace

void read_views(const ViewSections& sections, RoundedPoints& points, const std::vector<Rig>& rigs,
                std::vector<Keyframe>& keyframes, PartSizes& sizes) {
  const ByteReader observations = sections.observations;
  // Sequential reading repeats a failed attempt, so that always the first error is reported.
  sizes.views.assign(keyframes.size(), {});
  if (!try_to_read_views(sections, points.points, rigs, keyframes, sizes)) {
    sizes.views.assign(keyframes.size(), {});
    read_views_in_order(sections, points.points, rigs, keyframes, sizes);
  }
  set_references(observations, keyframes, points);
  if (has_too_many_covisible_keyframes(keyframes, points.points.size(), observations.remaining())) {
    observations.fail("has more covisible keyframes than a file of this size can hold");
  }
}

void read_view(ViewSections parts, std::uint32_t number, const Rig& rig, std::size_t point_count,
               const std::function<const ObservedPoint&(std::uint32_t)>& find_point, Keyframe& keyframe) {
  PartOfView part{read_keypoints(parts.features, rig, number), {}};
  const auto require_seen = [&](std::uint32_t point, int feature) {
    const Observation seen{{Origin::offline, number}, feature};
    if (std::ranges::binary_search(find_point(point).observations, seen)) return;
    require_no_fault(parts.observations, "does not list a keyframe that observes it", "point", point);
  };
  keyframe.sightings = read_sightings(parts.observations, part.keypoints, number, point_count, require_seen);
  std::vector<Descriptor> descriptors =
      read_descriptors(parts.descriptors, keyframe.sightings,
                       [&](std::uint32_t point) -> const Descriptor& { return find_point(point).point.descriptor; });
  part.patches = read_patches(parts, part.keypoints.bits, number);
  keyframe.frame.features = features_of_view(parts.features, std::move(part), std::move(descriptors), rig, number);
  for (const ByteReader* const read : {&parts.features, &parts.patches, &parts.observations, &parts.descriptors}) {
    read->require_end();
  }
}

}  // namespace byre
