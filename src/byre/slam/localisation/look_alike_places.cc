#include "byre/slam/localisation/look_alike_places.h"

#include "byre/features/descriptor.h"
#include "byre/slam/places/place_view.h"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

namespace byre {
namespace {

constexpr double kCellOfShifts = 0.5;   // metres
constexpr double kLargestShift = 30.0;  // metres, bounds the time

struct PlacedDescriptor {
  PointId id;
  Eigen::Vector3d position;  // metres, in the map
  Descriptor descriptor;
};

// A point elsewhere that looks like a point of the place.
struct AlikePoint {
  std::array<int, 3> cell{};  // cell of the shift
  PointId of_place;
  PointId elsewhere;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // metres, from of_place to elsewhere
};

bool are_similar(const Descriptor& a, const Descriptor& b) {
  constexpr int kMostBits = 55;  // bits
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) <= kMostBits && hamming_distance(a, b) <= kMostBits;
}

std::vector<PlacedDescriptor> descriptors_of(const MapGraph& map, std::span<const PointId> points) {
  std::vector<PlacedDescriptor> placed;
  placed.reserve(points.size());
  for (const PointId id : points) {
    const MapPoint& point = *map.find_point(id);
    placed.push_back({id, point.position_in_world, point.descriptor});
  }
  return placed;
}

// Points within kLargestShift.
std::vector<PlacedDescriptor> descriptors_around(const MapGraph& map, std::span<const PlacedDescriptor> place) {
  Eigen::AlignedBox3d box;
  for (const PlacedDescriptor& point : place) box.extend(point.position);
  std::vector<PlacedDescriptor> around = descriptors_of(map, map.point_ids());
  std::erase_if(around, [&](const PlacedDescriptor& point) {
    return box.squaredExteriorDistance(point.position) > kLargestShift * kLargestShift;
  });
  return around;
}

// Look-alike pairs, ascending by cell, then by the point of the place.
std::vector<AlikePoint> similar_points(const MapGraph& map, std::span<const PointId> points_of_place) {
  constexpr double kLeastShift = 1.0;  // metres
  const std::vector<PlacedDescriptor> place = descriptors_of(map, points_of_place);
  std::vector<AlikePoint> alike;
  for (const PlacedDescriptor& other : descriptors_around(map, place)) {
    for (const PlacedDescriptor& point : place) {
      if (!are_similar(point.descriptor, other.descriptor)) continue;
      const Eigen::Vector3d shift = other.position - point.position;
      if (shift.norm() < kLeastShift || shift.norm() > kLargestShift) continue;
      const Eigen::Vector3i cell = (shift / kCellOfShifts).array().round().cast<int>();
      alike.push_back({{cell.x(), cell.y(), cell.z()}, point.id, other.id, shift});
    }
  }
  std::ranges::sort(alike, {}, [](const AlikePoint& pair) { return std::tie(pair.cell, pair.of_place); });
  return alike;
}

// Pairs of the cell with most points of the place, one pair for each point.
std::vector<AlikePoint> most_consistent(std::span<const AlikePoint> alike) {
  std::vector<AlikePoint> most, cell;
  for (const AlikePoint& pair : alike) {
    if (!cell.empty() && cell.front().cell != pair.cell) cell.clear();
    if (cell.empty() || cell.back().of_place != pair.of_place) cell.push_back(pair);
    if (cell.size() > most.size()) most = cell;
  }
  return most;
}

// Removes the pairs whose shift is about the mean of the agreeing ones, and returns them as a place.
LookAlikePlace take_place(std::span<const AlikePoint> agreeing, std::vector<AlikePoint>& alike) {
  LookAlikePlace place;
  for (const AlikePoint& pair : agreeing) place.shift += pair.shift / static_cast<double>(agreeing.size());
  std::erase_if(alike, [&](const AlikePoint& pair) {
    if ((pair.shift - place.shift).norm() > 2.0 * kCellOfShifts) return false;
    place.repeated.insert(place.repeated.end(), {pair.of_place, pair.elsewhere});
    return true;
  });
  std::ranges::sort(place.repeated);
  place.repeated.erase(std::ranges::unique(place.repeated).begin(), place.repeated.end());
  return place;
}

}  // namespace

std::vector<LookAlikePlace> look_alike_places(const OfflineMap& offline, const Pose& camera_from_place) {
  constexpr std::size_t kMostPlaces = 4;
  constexpr std::size_t kMinPoints = 8;
  constexpr double kMinShare = 0.02;  // share of the points of the place
  const ScratchVector<PointId> points = points_of_place(offline, keyframes_of_place(offline, camera_from_place));
  const std::size_t enough =
      std::max(kMinPoints, static_cast<std::size_t>(kMinShare * static_cast<double>(points.size())));
  std::vector<AlikePoint> alike = similar_points(offline.map(), points);
  std::vector<LookAlikePlace> places;
  while (places.size() < kMostPlaces) {
    const std::vector<AlikePoint> most = most_consistent(alike);
    if (most.size() < enough) break;
    places.push_back(take_place(most, alike));
  }
  return places;
}

void add_look_alikes(std::span<const LookAlikePlace> more, std::vector<LookAlikePlace>& places) {
  constexpr std::size_t kMostInAll = 6;  // bounds the time of a frame
  constexpr double kSameShift = 1.0;     // metres
  for (const LookAlikePlace& place : more) {
    const auto is_same = [&](const LookAlikePlace& known) {
      return std::min((known.shift - place.shift).norm(), (known.shift + place.shift).norm()) <= kSameShift;
    };
    if (places.size() < kMostInAll && std::ranges::none_of(places, is_same)) places.push_back(place);
  }
}

}  // namespace byre
