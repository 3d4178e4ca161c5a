#pragma once

#include "byre/slam/place_view.h"
#include "byre/slam/registration.h"

#include <array>
#include <cmath>
#include <vector>

namespace byre {

// Prior log-odds of a place that the measured motion of the robot does not lead to: one such find in a hundred is of a
// robot that was carried.
inline const double kLogOddsOfCarried = -std::log(100.0);

// Whether the offline map is what a robot at a pose sees: the log-likelihood ratio, in nats, of that pose against any
// other place (Wald 1945).
//
// The map is divided into cells. A cell whose points should be in view either shows some of them or does not, and each
// cell counts once, however many frames and points show it: things are moved and covered as a whole, and a robot that
// stands still learns nothing new. A thing that was moved (a gate's leaf, the side of a wagon) agrees with the map
// wherever it stands now. So the agreeing cells that one such thing can hold add no more than the prior probability
// that it was moved.
class PlaceHypothesis {
 public:
  // Nothing to test: the pose is right by definition, as in the frame of a map that is being made.
  PlaceHypothesis() = default;
  // A pose found without a prediction. prior: log-odds by everything but the offline points. accept: log-odds from
  // which it is accepted.
  PlaceHypothesis(double prior, int frames_to_believe, double accept = RegistrationOptions{}.accept_log_odds)
      : prior_(prior), accept_(accept), frames_to_believe_(frames_to_believe), is_accepted_(false) {}

  // A frame was found at the pose, or tracked on it.
  void observe(const PlaceView& view, bool is_tracked);

  // The pose was lost shortly, and found again where the robot can be.
  void find_again(int frames_to_believe) { frames_to_believe_ = frames_to_believe; }

  double log_odds() const { return log_odds_; }
  // Enough frames were tracked on it for mapping to use it.
  bool is_believed() const { return frames_to_believe_ == 0; }
  // The test has accepted it, and not rejected it since.
  bool is_accepted() const { return is_accepted_; }

 private:
  struct Cell {
    std::array<int, 3> index{};  // see MapCells
    int last_frame = 0;
    int frames = 0;         // frames that expected its points, up to the length of the mean
    double expected = 0.0;  // points, mean
    double seen = 0.0;      // points, mean
    Eigen::Vector3d centre_of_seen = Eigen::Vector3d::Zero();  // metres, in the map
  };
  double evidence() const;

  double prior_ = 0.0;
  double accept_ = RegistrationOptions{}.accept_log_odds;
  int frames_to_believe_ = 0;
  bool is_accepted_ = true;
  double log_odds_ = 0.0;
  int frame_ = 0;
  std::vector<Cell> cells_;  // ascending
};

}  // namespace byre
