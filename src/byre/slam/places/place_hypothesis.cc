#include "byre/slam/places/place_hypothesis.h"

#include <span>

#include <Eigen/Eigenvalues>

namespace byre {
namespace {

constexpr double kMinExpected = 6.0;  // expected points from which a cell counts

// Log-likelihood ratios of a right against a wrong pose by one cell, by the share of its points that is seen, with few
// and with many expected points. Counted on 4,800 right and 720 wrong poses of rendered rooms and barns (exact and good
// calibrations, moved things, 376x240 and 752x480, one camera and two). Of the cells with many points, two thirds show
// less than a fiftieth of them at wrong poses and 10 to 30 % at right ones; 5 % and 13 to 49 % show more than a fifth.
constexpr std::array kShares = {0.02, 0.05, 0.1, 0.2};
constexpr std::array kOfFewPoints = {-0.45, 0.6, 0.6, 0.6, 0.9};
constexpr std::array kOfManyPoints = {-1.2, 0.0, 0.5, 1.0, 1.6};
constexpr double kManyExpected = 20.0;
constexpr double kLeastSeen = 0.5;  // mean of the cell's frames; less is as if no point was seen

double evidence_of(double expected, double seen) {
  const auto share = seen < kLeastSeen ? kShares.begin() : std::ranges::upper_bound(kShares, seen / expected);
  const std::size_t level = static_cast<std::size_t>(share - kShares.begin());
  return expected >= kManyExpected ? kOfManyPoints[level] : kOfFewPoints[level];
}

// Prior: one find in ten is of a moved object.
const double kOfMovedThing = std::log(10.0);

// Prior: one tag in thirty was moved, or has a copy.
const double kOfTag = std::log(30.0);

constexpr double kReject = -4.0;  // log-odds at which an accepted place is rejected

constexpr int kLengthOfMean = 6;     // frames over which a cell's points are averaged
constexpr int kFramesToForget = 50;  // frames out of view after which a cell or tag is forgotten

struct AgreeingCell {
  Eigen::Vector3d centre;  // metres, in the map
  double evidence = 0.0;
};
using Cells = ScratchVector<AgreeingCell>;

Cells cells_around(const Eigen::Vector3d& middle, const Cells& cells) {
  constexpr double kReach = 2.0;  // metres, half the size of a large object
  Cells around;
  for (const AgreeingCell& cell : cells) {
    if ((cell.centre - middle).norm() <= kReach) around.push_back(cell);
  }
  return around;
}

Eigen::Vector3d mean_of(const Cells& cells) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const AgreeingCell& cell : cells) sum += cell.centre;
  return sum / static_cast<double>(cells.size());
}

double sum_of(std::span<const AgreeingCell> cells) {
  double sum = 0.0;
  for (const AgreeingCell& cell : cells) sum += cell.evidence;
  return sum;
}

// Evidence of the cells on the plane of least squares; at least that of the strongest three, through which a plane
// always passes.
double evidence_on_plane(Cells cells) {
  constexpr double kThickness = 0.6;    // metres from the plane, largest distance of a cell on it
  constexpr std::size_t kAnyPlane = 3;  // cells that any plane passes through
  if (cells.size() <= kAnyPlane) return sum_of(cells);
  const Eigen::Vector3d mean = mean_of(cells);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const AgreeingCell& cell : cells) scatter += (cell.centre - mean) * (cell.centre - mean).transpose();
  const Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>().computeDirect(scatter).eigenvectors().col(0);
  std::ranges::sort(cells, std::ranges::greater{}, &AgreeingCell::evidence);
  const double strongest = sum_of(std::span(cells).first(kAnyPlane));
  std::erase_if(cells, [&](const AgreeingCell& cell) { return std::abs(normal.dot(cell.centre - mean)) > kThickness; });
  return std::max(strongest, sum_of(cells));
}

// Largest evidence of cells that one moved object can cover: those on a plane, within kReach of their middle.
double most_on_one_thing(const Cells& cells) {
  double most = 0.0;
  for (const AgreeingCell& cell : cells) {
    const Cells thing = cells_around(mean_of(cells_around(cell.centre, cells)), cells);
    if (sum_of(thing) > most) most = std::max(most, evidence_on_plane(thing));
  }
  return most;
}

}  // namespace

double PlaceHypothesis::evidence(Count Cell::*points) const {
  double all = 0.0;
  Cells agreeing;
  for (const Cell& cell : cells_) {
    const auto& [expected, seen] = cell.*points;
    if (expected < kMinExpected) continue;
    const double by_cell = evidence_of(expected, seen);
    all += by_cell;
    if (by_cell > 0.0) agreeing.push_back({cell.centre_of_seen, by_cell});
  }
  return std::min(all, all - most_on_one_thing(agreeing) + kOfMovedThing);
}

// Contradicting tags count as one: what moves one tag, such as a new shelf, moves those beside it.
double PlaceHypothesis::evidence_of_tags() const {
  constexpr std::ptrdiff_t kMostAgreeing = 2;
  const std::ptrdiff_t agreeing = std::ranges::count(tags_, 0, &SeenTag::contradictions);
  const std::ptrdiff_t contradicting = is_contradicted_by_tag() ? 1 : 0;
  return kOfTag * static_cast<double>(std::min(agreeing, kMostAgreeing) - contradicting);
}

void PlaceHypothesis::observe(const PlaceView& view, bool is_tracked, double log_odds_of_rivals) {
  if (is_tracked) confirmations_left_ = std::max(0, confirmations_left_ - 1);
  ++frame_;
  // If no keyframe saw the map from nearby, walls may hide expected points. Missing points then count against a place
  // that is not accepted, but not against an accepted one.
  if (is_accepted_ && !view.is_near_keyframe) return;
  for (const CellInView& seen : view.cells) {
    auto cell = std::ranges::lower_bound(cells_, seen.cell, {}, &Cell::index);
    if (cell == cells_.end() || cell->index != seen.cell) cell = cells_.insert(cell, Cell{.index = seen.cell});
    const double weight = 1.0 / (cell->frames + 1);
    cell->all.expected += weight * (seen.expected - cell->all.expected);
    cell->all.seen += weight * (seen.seen - cell->all.seen);
    cell->alone.expected += weight * (seen.expected_alone - cell->alone.expected);
    cell->alone.seen += weight * (seen.seen_alone - cell->alone.seen);
    if (seen.seen > 0) cell->centre_of_seen = seen.centre_of_seen;
    cell->frames = std::min(cell->frames + 1, kLengthOfMean - 1);
    cell->last_frame = frame_;
  }
  for (const auto& [id, agrees] : view.tags) {
    auto tag = std::ranges::find(tags_, id, &SeenTag::id);
    if (tag == tags_.end()) tag = tags_.insert(tag, SeenTag{.id = id});
    tag->contradictions = agrees ? 0 : tag->contradictions + 1;
    tag->last_frame = frame_;
  }
  const auto is_forgotten = [this](const auto& seen) { return frame_ - seen.last_frame > kFramesToForget; };
  std::erase_if(cells_, is_forgotten);
  std::erase_if(tags_, is_forgotten);
  const double by_others = prior_ + evidence_of_tags();
  log_odds_ = by_others + evidence(&Cell::all);
  log_odds_to_rivals_ = by_others + evidence(&Cell::alone);
  const double least = std::min(log_odds_, log_odds_to_rivals_);
  if (is_confirmed() && log_odds_ >= accept_ && least - log_odds_of_rivals >= accept_) {
    is_accepted_ = true;
    prior_ = std::max(prior_, 0.0);  // the cells that outweighed it may be forgotten earlier
  }
  if (is_rejected()) is_accepted_ = false;
}

int PlaceHypothesis::contradictions(const TagId& tag) const {
  const auto seen = std::ranges::find(tags_, tag, &SeenTag::id);
  return seen != tags_.end() ? seen->contradictions : 0;
}

bool PlaceHypothesis::is_rejected() const {
  return log_odds_ <= kReject;
}

double log_odds_of(const PlaceView& view) {
  PlaceHypothesis place(0.0, 0);
  place.observe(view, true);
  return place.log_odds();
}

}  // namespace byre
