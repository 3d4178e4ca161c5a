#include "byre/slam/place_hypothesis.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace byre {
namespace {

// Shares of agreeing cells at right and at wrong poses. Measured on real and simulated missions by day, at dusk and
// with half of the things moved.
constexpr double kAgreeingWhereRight = 0.55;
constexpr double kAgreeingWhereWrong = 0.18;
const double kOfAgreement = std::log(kAgreeingWhereRight / kAgreeingWhereWrong);
const double kOfDisagreement = std::log((1.0 - kAgreeingWhereRight) / (1.0 - kAgreeingWhereWrong));
constexpr double kMinExpected = 8.0;  // expected points from which a cell counts
constexpr double kMinShare = 0.03;    // least share of seen points of an agreeing cell; chance gives a tenth of it

// Prior: one find in ten is of a moved thing.
const double kOfMovedThing = std::log(10.0);

constexpr double kReject = -4.0;  // log-odds at which an accepted place is rejected

constexpr int kLengthOfMean = 6;     // frames over which a cell's points are averaged
constexpr int kFramesToForget = 50;  // frames out of view after which a cell is forgotten

using Places = ReusedVector<Eigen::Vector3d>;

Places places_around(const Eigen::Vector3d& middle, const Places& places) {
  constexpr double kReach = 2.0;  // metres, half the size of a large thing
  Places around;
  for (const Eigen::Vector3d& place : places) {
    if ((place - middle).norm() <= kReach) around.push_back(place);
  }
  return around;
}

Eigen::Vector3d mean_of(const Places& places) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) sum += place;
  return sum / static_cast<double>(places.size());
}

// Number of places on the plane of least squares; at least three, through which a plane always passes.
int count_on_plane(const Places& places) {
  constexpr double kThickness = 0.6;    // metres from the plane, largest distance of a place on it
  constexpr std::size_t kAnyPlane = 3;  // places that any plane passes through
  if (places.size() <= kAnyPlane) return static_cast<int>(places.size());
  const Eigen::Vector3d mean = mean_of(places);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& place : places) scatter += (place - mean) * (place - mean).transpose();
  const Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>().computeDirect(scatter).eigenvectors().col(0);
  const auto on_plane = std::ranges::count_if(
      places, [&](const Eigen::Vector3d& place) { return std::abs(normal.dot(place - mean)) <= kThickness; });
  return std::max(static_cast<int>(kAnyPlane), static_cast<int>(on_plane));
}

// Largest number of places that one moved thing can cover: those on a plane, within kReach of their middle.
int most_on_one_thing(const Places& places) {
  int most = 0;
  for (const Eigen::Vector3d& place : places) {
    const Places thing = places_around(mean_of(places_around(place, places)), places);
    if (static_cast<int>(thing.size()) > most) most = std::max(most, count_on_plane(thing));
  }
  return most;
}

}  // namespace

double PlaceHypothesis::evidence(Count Cell::*points) const {
  double all = 0.0;
  Places agreeing;
  for (const Cell& cell : cells_) {
    const auto& [expected, seen] = cell.*points;
    if (expected < kMinExpected) continue;
    const bool agrees = seen >= std::max(1.0, kMinShare * expected);
    all += agrees ? kOfAgreement : kOfDisagreement;
    if (agrees) agreeing.push_back(cell.centre_of_seen);
  }
  return std::min(all, all - most_on_one_thing(agreeing) * kOfAgreement + kOfMovedThing);
}

void PlaceHypothesis::observe(const PlaceView& view, bool is_tracked, double log_odds_of_rivals) {
  if (is_tracked) frames_to_believe_ = std::max(0, frames_to_believe_ - 1);
  ++frame_;
  // Where no keyframe saw the map from nearby, walls may hide expected points. Missing points then count against a
  // place that is not accepted, but not against an accepted one.
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
  std::erase_if(cells_, [this](const Cell& cell) { return frame_ - cell.last_frame > kFramesToForget; });
  log_odds_ = prior_ + evidence(&Cell::all);
  log_odds_to_rivals_ = prior_ + evidence(&Cell::alone);
  if (is_believed() && log_odds_ >= accept_ && log_odds_to_rivals_ - log_odds_of_rivals >= accept_) {
    is_accepted_ = true;
    prior_ = std::max(prior_, 0.0);  // outweighed by cells that may be forgotten before it is
  }
  if (is_rejected()) is_accepted_ = false;
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
