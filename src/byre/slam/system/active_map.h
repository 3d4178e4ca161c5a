#pragma once

#include "byre/frame_report.h"
#include "byre/plan_registration.h"
#include "byre/site.h"
#include "byre/slam/localisation/place_search.h"
#include "byre/slam/places/place_hypothesis.h"
#include "byre/slam/window/registration.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Map of a site on which the robot is: that of the session, until another one explains the frames better. Each map has
// a test of the place where searches find the robot (PlaceHypothesis); the other maps are its rivals. A value.
//
// The map is proved, and poses may be trusted, once the session has accepted a place and a few searches of its frames
// in all maps found no likely rival. A loss of one second, a lift, and a change of the map end the proof. While it
// lasts, nothing is searched but after a link's region was entered, when only the link's map can become the active one,
// and far outside the mapped area, when any can.
class ActiveMap {
 public:
  // plans: registration of each map on a floor plan, if any.
  ActiveMap(std::vector<SiteLink> links, std::vector<std::optional<PlanRegistration>> plans,
            const RegistrationOptions& options);

  std::size_t index() const { return index_; }
  bool is_proved() const { return is_proved_; }
  // Whether to search a frame of this time in all maps, for note_search().
  bool is_search_due(Timestamp time) const;
  // Adds a frame that was searched in all maps, see search_places().
  void note_search(std::span<const PlaceSearch> by_map);
  // Adds the session's report of a frame. log_odds: of its place, see Session::log_odds_of_place(). Returns the map
  // which a new session begins on, if any; the present map after a lift.
  std::optional<std::size_t> note(const FrameReport& report, double log_odds);

 private:
  struct Test {
    Timestamp time{};  // time of the last frame found
    Eigen::Vector3d camera_in_map = Eigen::Vector3d::Zero();
    PlaceHypothesis place;
    int misses = 0;  // searches in a row without the map
  };
  bool is_in(const SiteLink& link, const Pose& map_from_body) const;
  void enter_links(Timestamp time, const Pose& map_from_body);
  bool is_linked(std::size_t map, Timestamp time) const;
  double log_odds_of(std::size_t map) const;  // by searches
  double log_odds_of_rivals(std::size_t map, double log_odds_of_active) const;
  std::size_t begin_on(std::size_t map);

  // Constant after construction.
  std::vector<SiteLink> links_;
  std::vector<std::optional<PlanRegistration>> plans_;
  RegistrationOptions options_;

  std::size_t index_ = 0;
  std::vector<std::optional<Test>> tests_;        // by map
  std::vector<std::optional<Timestamp>> linked_;  // by map: last frame in a link's region
  std::optional<Timestamp> placed_since_;         // first frame of the session's present place
  std::optional<Timestamp> last_placed_;          // last frame with a place
  int searches_ = 0;                              // searches of frames since placed_since_
  bool is_in_lift_ = false;
  bool is_far_ = false;  // outside the active map
  bool is_proved_ = false;
};

}  // namespace byre
