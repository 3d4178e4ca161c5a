#include "byre/slam/system/active_map.h"

#include "byre/geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr Timestamp kLongestGap = std::chrono::seconds(1);  // without a place, in which no robot leaves a map
constexpr Timestamp kAfterLink = std::chrono::seconds(20);  // after a link's region, until its map is found

}  // namespace

ActiveMap::ActiveMap(std::vector<SiteLink> links, std::vector<std::optional<PlanRegistration>> plans,
                     const RegistrationOptions& options)
    : links_(std::move(links)),
      plans_(std::move(plans)),
      options_(options),
      tests_(plans_.size()),
      linked_(plans_.size()),
      is_proved_(plans_.size() == 1) {}

bool ActiveMap::is_in(const SiteLink& link, const Pose& map_from_body) const {
  if (link.from != index_) return false;
  if (link.polygon.empty()) return (map_from_body.translation - link.centre).norm() <= link.radius;
  const auto& plan = plans_[index_];
  return plan && is_inside(link.polygon, plan_from_body(*plan, map_from_body).translation.head<2>());
}

void ActiveMap::enter_links(Timestamp time, const Pose& map_from_body) {
  is_in_lift_ = false;
  for (const SiteLink& link : links_) {
    if (!is_in(link, map_from_body)) continue;
    linked_[link.to] = time;
    if (link.kind == LinkKind::lift) is_in_lift_ = true;
  }
}

bool ActiveMap::is_linked(std::size_t map, Timestamp time) const {
  return linked_[map] && time - *linked_[map] <= kAfterLink;
}

bool ActiveMap::is_search_due(Timestamp time) const {
  if (tests_.size() == 1) return false;
  if (!is_proved_ || is_far_) return true;
  for (std::size_t map = 0; map < linked_.size(); ++map) {
    if (is_linked(map, time)) return true;
  }
  return false;
}

void ActiveMap::note_search(std::span<const PlaceSearch> by_map) {
  constexpr Timestamp kLongestPause = std::chrono::seconds(3);
  constexpr double kSlack = 0.3;  // metres, error of poses
  constexpr int kMostMisses = 4;
  for (std::size_t map = 0; map < tests_.size(); ++map) {
    std::optional<Test>& test = tests_[map];
    const PlaceSearch& search = by_map[map];
    const bool is_over =
        test && (search.time - test->time > kLongestPause || (!search.found && ++test->misses > kMostMisses));
    if (is_over) test.reset();
    if (!search.found) continue;
    const Eigen::Vector3d camera = inverse(search.found->camera_from_offline).translation;
    const double reach = test ? kSlack + options_.max_speed * to_seconds(search.time - test->time) : 0.0;
    if (!test || (camera - test->camera_in_map).norm() > reach) {
      test.emplace().place = PlaceHypothesis(0.0, options_.confirmations, options_.accept_log_odds);
    }
    test->time = search.time;
    test->camera_in_map = camera;
    test->misses = 0;
    test->place.observe(search.found->view, true);
  }
  if (placed_since_ && by_map.front().time >= *placed_since_) ++searches_;
}

double ActiveMap::log_odds_of(std::size_t map) const {
  return tests_[map] ? tests_[map]->place.log_odds() : kNoRivals;
}

double ActiveMap::log_odds_of_rivals(std::size_t map, double log_odds_of_active) const {
  double odds = 0.0;
  for (std::size_t rival = 0; rival < tests_.size(); ++rival) {
    if (rival != map) odds += std::exp(rival == index_ ? log_odds_of_active : log_odds_of(rival));
  }
  return std::log(odds);
}

std::size_t ActiveMap::begin_on(std::size_t map) {
  index_ = map;
  is_proved_ = tests_.size() == 1;
  is_in_lift_ = is_far_ = false;
  linked_.assign(linked_.size(), std::nullopt);
  placed_since_.reset();
  last_placed_.reset();
  searches_ = 0;
  return map;
}

std::optional<std::size_t> ActiveMap::note(const FrameReport& report, double log_odds) {
  constexpr int kSearches = 3;        // least number, with frames at the session's place
  constexpr double kOffTheMap = 0.5;  // metres without offline points, from which another map may be the active one
  const bool is_placed = report.map_from_body && log_odds > kNoRivals;
  const bool is_gap = !last_placed_ || report.time - *last_placed_ > kLongestGap;
  const bool was_in_lift = is_in_lift_;
  if (is_gap || report.has(SessionEvent::place_refuted)) {
    is_proved_ = tests_.size() == 1;
    placed_since_.reset();
    searches_ = 0;
  }
  if (is_placed) {
    if (!placed_since_) placed_since_ = report.time;
    last_placed_ = report.time;
    enter_links(report.time, *report.map_from_body);
  }
  if (is_in_lift_) is_proved_ = false;
  if (was_in_lift && !is_in_lift_) {
    tests_.assign(tests_.size(), std::nullopt);  // tests may be of the lift's inside
    return begin_on(index_);
  }
  is_far_ = is_proved_ && report.health.doubt == DistrustReason::off_the_map;
  const bool is_left = is_proved_ && report.health.distance_since_offline > kOffTheMap;
  const double of_active = is_far_   ? log_odds_of(index_)
                           : is_left ? kNoRivals
                                     : std::max(log_odds, log_odds_of(index_));
  for (std::size_t map = 0; map < tests_.size(); ++map) {
    if (map == index_ || !tests_[map] || !tests_[map]->place.is_confirmed()) continue;
    if (is_proved_ && !is_far_ && !is_linked(map, report.time)) continue;
    const double of_map = log_odds_of(map);
    const double margin = of_map - log_odds_of_rivals(map, of_active);
    if (std::min(of_map, margin) >= options_.accept_log_odds) return begin_on(map);
  }
  if (is_proved_ || is_in_lift_ || searches_ < kSearches || report.health.verdict != Verdict::trusted) return {};
  // By searches of the same frames, as the session has seen more of its place than searches of the rivals.
  const double of_rivals = log_odds_of_rivals(index_, of_active);
  is_proved_ = of_rivals == kNoRivals || log_odds_of(index_) - of_rivals >= options_.accept_log_odds;
  return {};
}

}  // namespace byre
