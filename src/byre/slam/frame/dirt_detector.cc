#include "byre/slam/frame/dirt_detector.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace byre {
namespace {

constexpr int kMinTrials = 30;        // trials in the rest of the image
constexpr double kCleanShare = 0.6;   // minimum share of found points in a clean cell, relative to the rest
constexpr double kDirtyShare = 0.1;   // share of points found behind dirt, mostly by chance
const double kProof = std::log(1e6);  // log-likelihood ratio of a dirty cell
// Dirt is larger than a cell, so less evidence is needed next to a dirty cell.
const double kProofBesideDirt = std::log(1e2);
const double kSuspicious = std::log(10.0);  // cells that do not count as the rest of the image

// Evidence of simultaneous trials in a cell; found: share of points found. Such trials often show one object, so their
// weight is the square root of their number.
double evidence_of(double found, int trials, double rest) {
  const double clean = kCleanShare * rest;
  const double dirty = kDirtyShare * rest;
  return std::sqrt(trials) *
         (found * std::log(dirty / clean) + (1.0 - found) * std::log((1.0 - dirty) / (1.0 - clean)));
}

constexpr double kEvery = 0.19;       // seconds between the frames used
constexpr double kRemembered = 3.0;   // seconds since a point was seen
constexpr int kMinSeen = 30;          // tracked points in a frame
constexpr float kFreeBorder = 19.0f;  // octave pixels along the image border without corners
constexpr SearchOptions kBehindDirt{4.0f, 80, 0.9f};

float cell_size(const Rig& rig) {
  return std::max(static_cast<float>(rig.width) / ImageMask::kColumns,
                  static_cast<float>(rig.height) / ImageMask::kRows);
}

bool is_inside(const Eigen::Vector2d& pixel, double border, const Rig& rig) {
  return std::min(pixel.x(), rig.width - 1 - pixel.x()) > border &&
         std::min(pixel.y(), rig.height - 1 - pixel.y()) > border;
}

// Border without corners of the point's octave and the next one, pixels.
double border_of(const Projection& projection) {
  const int octave = std::min(projection.octave + 1, kOctaves - 1);
  return kFreeBorder * kScaleOfOctave[static_cast<std::size_t>(octave)];
}

}  // namespace

bool DirtMask::is_next_to_dirt(std::size_t cell) const {
  constexpr auto kColumns = static_cast<std::size_t>(ImageMask::kColumns);
  const std::size_t column = cell % kColumns;
  return (column > 0 && hidden_.is_hidden(cell - 1)) || (column + 1 < kColumns && hidden_.is_hidden(cell + 1)) ||
         (cell >= kColumns && hidden_.is_hidden(cell - kColumns)) ||
         (cell + kColumns < ImageMask::kCells && hidden_.is_hidden(cell + kColumns));
}

void DirtMask::note(std::span<const DirtTrial> trials, const Rig& rig) {
  for (const DirtTrial& trial : trials) {
    Count& count = counts_[ImageMask::cell_of(trial.pixel, rig)];
    ++count.all;
    count.found += trial.is_found ? 1 : 0;
  }
  std::array<bool, ImageMask::kCells> of_rest{};
  Count rest;
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
    of_rest[cell] = !hidden_.is_hidden(cell) && evidence_[cell] < kSuspicious;
    if (of_rest[cell]) rest = {rest.found + counts_[cell].found, rest.all + counts_[cell].all};
  }
  if (rest.all < kMinTrials) return;
  ImageMask after = hidden_;
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
    const Count here = std::exchange(counts_[cell], {});
    const Count others = of_rest[cell] ? Count{rest.found - here.found, rest.all - here.all} : rest;
    if (here.all == 0 || others.found == 0) continue;
    const double found = static_cast<double>(here.found) / here.all;
    const double found_elsewhere = static_cast<double>(others.found) / others.all;
    double& evidence = evidence_[cell];
    evidence = std::clamp(evidence + evidence_of(found, here.all, found_elsewhere), 0.0, kProof);
    if (evidence >= (is_next_to_dirt(cell) ? kProofBesideDirt : kProof)) after.set(cell, true);
    if (evidence == 0.0) after.set(cell, false);
  }
  hidden_ = after;
}

bool DirtDetector::has_left_cell(const Eigen::Vector2f& pixel, const Sight& since, const Rig& rig) {
  return (pixel - since.pixel).norm() > cell_size(rig);
}

// Searches each point once for each cell that it passes, found or not.
void DirtDetector::try_sights(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map) {
  const Eigen::Vector3d camera_in_world = inverse(camera_from_world).translation;
  trials_.clear();
  trials_right_.clear();
  reserve_pow2(trials_, sights_.size());
  reserve_pow2(trials_right_, sights_.size());
  auto seen = now_.begin();  // both in the order of points
  const auto is_over = [&](Sight& sight) {
    while (seen != now_.end() && seen->point < sight.point) ++seen;
    const bool is_seen = seen != now_.end() && seen->point == sight.point;
    if (is_seen) sight.seen = frame.time;
    if (to_seconds(frame.time - sight.seen) > kRemembered) return true;
    const bool was_in_right = sight.is_in_right;
    if (is_seen && frame.right_condition) sight.is_in_right = seen->is_in_right;
    if (is_seen && !has_left_cell(seen->pixel, sight, rig)) return false;
    const MapPoint* const point = map.find_point(sight.point);
    const auto projection =
        point ? project_point(*point, camera_from_world, camera_in_world, rig) : std::optional<Projection>();
    if (!projection) return true;
    const Eigen::Vector2f pixel = projection->predicted.head<2>().cast<float>();
    if (has_left_cell(pixel, sight, rig)) {
      try_sight(frame, was_in_right, is_seen ? &*seen : nullptr, *projection, rig, point->descriptor);
      sight.pixel = pixel;
    }
    return false;
  };
  auto kept = sights_.begin();
  for (Sight& sight : sights_) {
    if (!is_over(sight)) *kept++ = sight;
  }
  sights_.erase(kept, sights_.end());
}

// The right image is tested by points that the left one shows, except along its border, which rectification may leave
// empty.
void DirtDetector::try_sight(const Frame& frame, bool was_in_right, const Sight* now, const Projection& projection,
                             const Rig& rig, const Descriptor& descriptor) {
  const double border = border_of(projection);
  const Eigen::Vector2d left = projection.predicted.head<2>();
  if (!is_inside(left, border, rig)) return;
  const Eigen::Vector2d right(left.x() - projection.predicted.z(), left.y());
  if (now != nullptr && was_in_right && is_inside(right, border + cell_size(rig), rig)) {
    trials_right_.push_back({right, now->is_in_right});
  }
  trials_.push_back({left, now != nullptr || find_feature(*frame.features, descriptor, projection, kBehindDirt)});
}

std::optional<SessionEvent> DirtDetector::take_event() {
  constexpr double kMuchMore = 1.5;  // factor on the share last reported
  const double share = hidden().share() + hidden_right().share();
  if (share == 0.0 && reported_share_ == 0.0) return std::nullopt;
  if (share > 0.0 && reported_share_ > 0.0 && share < kMuchMore * reported_share_) return std::nullopt;
  reported_share_ = share;
  return share > 0.0 ? SessionEvent::dirt_found : SessionEvent::dirt_gone;
}

void DirtDetector::note(const Frame& frame, const TrackedFrame& tracked, const Rig& rig, const MapView& map) {
  if (last_ && to_seconds(frame.time - *last_) < kEvery) return;
  if (static_cast<int>(tracked.features.size()) < kMinSeen) return;
  last_ = frame.time;
  now_.clear();
  reserve_pow2(now_, tracked.features.size());
  for (const TrackedFeature& feature : tracked.features) {
    const bool is_in_right = frame.features->keypoint(feature.feature).has_disparity();
    now_.push_back({feature.point, feature.pixel, frame.time, is_in_right});
  }
  std::ranges::sort(now_, {}, &Sight::point);
  try_sights(frame, tracked.camera_from_world, rig, map);
  left_.note(trials_, rig);
  if (frame.right_condition) right_.note(trials_right_, rig);
  joined_.clear();
  reserve_pow2(joined_, sights_.size() + now_.size());
  std::ranges::set_union(sights_, now_, std::back_inserter(joined_), {}, &Sight::point, &Sight::point);
  std::swap(sights_, joined_);
}

}  // namespace byre
