#pragma once

#include "byre/slam/places/place_view.h"
#include "byre/slam/window/registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace byre {

// Prior log-odds of a place that contradicts the measured motion: one such find in a hundred is of a carried robot.
inline const double kLogOddsOfKidnapping = -std::log(100.0);

inline constexpr double kNoRivals = -std::numeric_limits<double>::infinity();

// Sequential likelihood-ratio test (Wald 1945) of a pose in a map against any other place. Log-odds in nats.
//
// The map is divided into cells. The share of a cell's points that is seen is evidence for or against the pose. Each
// cell counts once, however many frames and points show it: objects are moved and covered as a whole, and a robot at
// standstill gets no new evidence. A moved object (a gate's leaf, the side of a wagon) agrees with the map at its new
// place as well. So the agreeing cells that one such object can cover add no more than the log-odds against a moved
// object.
//
// Against a look-alike place (the next bay of a barn) only points that it does not have are evidence, and tags. A tag
// counts once, by its last detection.
class PlaceHypothesis {
 public:
  // Accepted without a test: the pose is right by definition, as in the frame of a map that is being made.
  PlaceHypothesis() = default;
  // A pose found without a prediction. prior: log-odds by other evidence than map points. confirmations:
  // tracked frames until mapping uses it. accept: log-odds from which it is accepted.
  PlaceHypothesis(double prior, int confirmations, double accept = RegistrationOptions{}.accept_log_odds)
      : prior_(prior), accept_(accept), confirmations_left_(confirmations), is_accepted_(false) {}

  // Adds a frame. is_tracked: at a pose that continues the one before; false: the first pose. log_odds_of_rivals: log
  // of the sum of the odds of the look-alike places that it is tested against, see RivalPlaces.
  void observe(const PlaceView& view, bool is_tracked, double log_odds_of_rivals = kNoRivals);

  // The pose was lost for a short time and found again within reach.
  void require_confirmations(int confirmations) { confirmations_left_ = confirmations; }

  double log_odds() const { return log_odds_; }  // against all places but look-alikes
  // Against a look-alike place, by points that it does not have.
  double log_odds_to_rivals() const { return log_odds_to_rivals_; }
  // Enough frames were tracked for mapping to use the pose.
  bool is_confirmed() const { return confirmations_left_ == 0; }
  // The test has accepted it, and not rejected it since.
  bool is_accepted() const { return is_accepted_; }
  bool is_rejected() const;
  // Detections of a tag in a row, the last ones, that contradict the pose.
  int contradictions(const TagId& tag) const;
  bool is_contradicted_by_tag() const { return std::ranges::any_of(tags_, &SeenTag::contradictions); }

 private:
  struct Count {
    double expected = 0.0;  // mean number of points that should be in view
    double seen = 0.0;      // mean number of points seen
  };
  struct Cell {
    std::array<int, 3> index{};  // see CellInView
    int last_frame = 0;
    int frames = 0;  // frames in the means
    Count all{};
    Count alone{};                                             // points that no look-alike place has
    Eigen::Vector3d centre_of_seen = Eigen::Vector3d::Zero();  // metres, in the map
  };
  struct SeenTag {
    TagId id;
    int contradictions = 0;
    int last_frame = 0;
  };
  double evidence(Count Cell::*points) const;
  double evidence_of_tags() const;

  double prior_ = 0.0;
  double accept_ = RegistrationOptions{}.accept_log_odds;
  int confirmations_left_ = 0;
  bool is_accepted_ = true;
  double log_odds_ = 0.0;
  double log_odds_to_rivals_ = 0.0;
  int frame_ = 0;
  std::vector<Cell> cells_;  // ascending by index
  std::vector<SeenTag> tags_;
};

// Log-odds of a pose by one frame alone, without a prior.
double log_odds_of(const PlaceView& view);

}  // namespace byre
