#include "byre/io/recording/restored_times.h"

#include "byre/base/enum_names.h"
#include "byre/geometry/median.h"
#include "byre/io/recording/stamp_clock.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using Times = std::vector<Timestamp>;

constexpr std::size_t kMaxRun = 10;   // largest number of late items, or wrong stamps, in a row
constexpr std::size_t kWindow = 20;   // items over which reception delays are compared
constexpr double kContinuous = 1.5;   // largest time, in intervals, between two items without a gap
constexpr Timestamp kMinStep = 20ms;  // a shorter step looks like jitter

// Later stamps are wrong. The difference of two stamps up to this one does not overflow.
constexpr Timestamp kLastStamp = std::chrono::seconds(4'294'967'296);

// Flags of items with a stamp. Zero is a valid stamp if the clock starts at zero: other stamps are near it, or only the
// first item has it and all others are within a day.
std::vector<bool> find_stamped(const Times& stamps) {
  static constexpr Timestamp kNearZero = 10s;
  static constexpr Timestamp kDay = std::chrono::days(1);
  const bool is_near_zero = std::ranges::any_of(
      stamps, [](Timestamp stamp) { return stamp != Timestamp{} && std::chrono::abs(stamp) < kNearZero; });
  const bool begins_at_zero =
      !stamps.empty() && stamps.front() == Timestamp{} && std::ranges::count(stamps, Timestamp{}) == 1 &&
      std::ranges::all_of(stamps, [](Timestamp stamp) { return std::chrono::abs(stamp) < kDay; });
  const bool is_zero_time = is_near_zero || begins_at_zero;
  std::vector<bool> are_stamped;
  for (const Timestamp stamp : stamps) {
    are_stamped.push_back(std::chrono::abs(stamp) <= kLastStamp && (is_zero_time || stamp != Timestamp{}));
  }
  return are_stamped;
}

// Makes stamps continuous: removes clock steps and marks wrong stamps.
class StampCorrector {
 public:
  struct Step {
    std::size_t item = 0;
    Timestamp by{};
  };

  // received: receive times; empty if they do not follow the rate of the stamps. Precondition: stamps are not empty.
  StampCorrector(const Times& stamps, const Times& received, Timestamp interval, bool is_order_certain)
      : stamps_(stamps),
        received_(received),
        interval_(interval),
        is_order_certain_(is_order_certain),
        times_(stamps),
        is_outlier_(stamps.size(), false),
        latest_from_(stamps) {
    for (std::size_t i = stamps_.size() - 1; i > 0; --i) {
      latest_from_[i - 1] = std::max(latest_from_[i - 1], latest_from_[i]);
    }
    constexpr std::size_t kMaxSteps = 3;
    place(0);
    if (is_order_certain_ || 4 * count_backward_steps() <= stamps_.size()) {
      for (std::size_t i = 1; i < stamps_.size();) i = advance(i);
      if (steps_.size() <= std::max(kMaxSteps, stamps_.size() / 10)) return;
    }
    revert_to_stamps();
  }

  const Times& times() const { return times_; }
  const std::vector<bool>& is_outlier() const { return is_outlier_; }
  const std::vector<Step>& steps() const { return steps_; }
  int late() const { return late_; }

 private:
  // Handles item i, and possibly items after it. Returns the next item.
  std::size_t advance(std::size_t i) {
    if (end_of_excursion_ && *end_of_excursion_ == i) {
      return set_clock(i, stamps_[i] - shift_before_);
    }
    if (stamps_[i] >= front()) {
      if (const std::size_t wrong = outliers_ahead(i); wrong > 0) return mark_outliers(i, i + wrong);
      if (is_forward_step(i)) return set_clock(i, expected_at(i));
      return place(i);
    }
    const std::size_t end = return_after(i);
    const bool returns = end < stamps_.size() && is_jump(end);
    if (is_order_certain_) {
      if (returns && end - i <= kMaxRun) return mark_outliers(i, end);
      return is_backward_step(i) ? set_clock(i, expected_at(i)) : mark_outliers(i, i + 1);
    }
    if (are_late(i, end)) return place_late(i, end);
    if (returns && continues(stamps_[end], end - i)) {
      if (end - i <= kMaxRun) return mark_outliers(i, end);
      shift_before_ = shift_;
      end_of_excursion_ = end;
      return set_clock(i, expected_at(i));
    }
    return is_backward_step(i) ? set_clock(i, expected_at(i)) : place_late(i, i + 1);
  }

  Timestamp front() const { return stamps_[front_]; }

  // First item after i whose stamp is later than all stamps before i; the number of items without one.
  std::size_t return_after(std::size_t i) const {
    if (latest_from_[i] <= front()) return stamps_.size();
    const auto after = stamps_.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    const auto end = std::find_if(after, stamps_.end(), [this](Timestamp stamp) { return stamp > front(); });
    return static_cast<std::size_t>(end - stamps_.begin());
  }

  bool is_jump(std::size_t i) const { return stamps_[i] - stamps_[i - 1] > multiple(kContinuous, interval_); }

  // Whether the stamp continues the clock after a number of items with other stamps.
  bool continues(Timestamp stamp, std::size_t without) const {
    const Timestamp passed = stamp - front(), usual = static_cast<Timestamp::rep>(without + 1) * interval_;
    return passed >= multiple(0.3, usual) && passed <= multiple(3.0, usual);
  }

  // Number of items from i on whose stamps are far ahead, until stamps continue; zero without such stamps.
  std::size_t outliers_ahead(std::size_t i) const {
    if (stamps_[i] - front() <= std::max<Timestamp>(static_cast<Timestamp::rep>(kMaxRun) * interval_, kMinForwardStep))
      return 0;
    for (std::size_t count = 1; count <= kMaxRun && i + count < stamps_.size(); ++count) {
      const Timestamp next = stamps_[i + count];
      if (next < stamps_[i] && continues(next, count)) return count;
    }
    return 0;
  }

  // Reception delays of items from i on, and the least one before. Precondition: received_ is not empty.
  Timestamp delay(std::size_t i) const { return received_[i] - stamps_[i]; }
  Times delays_from(std::size_t i) const {
    Times delays;
    for (std::size_t k = i; k < std::min(i + kWindow, stamps_.size()); ++k) delays.push_back(delay(k));
    return delays;
  }
  Timestamp min_delay_before() const {
    const std::size_t count = std::min(kWindow, placed_.size());
    Timestamp least = Timestamp::max();
    for (const std::size_t k : std::span(placed_).last(count)) least = std::min(least, delay(k));
    return least;
  }

  Timestamp backward_step_at(std::size_t i) const { return front() + interval_ - stamps_[i]; }

  // Whether reception delays from item `from` on are longer by the step.
  bool is_delayed_from(std::size_t from, Timestamp step) const {
    return std::ranges::min(delays_from(from)) - min_delay_before() > step / 2;
  }

  // A burst after a stall is also received faster than it was stamped. However, its items are delayed, whereas items
  // after a step are early.
  bool is_forward_step(std::size_t i) const {
    if (received_.empty()) return false;
    const Timestamp stamped = stamps_[i] - front(), waited = received_[i] - received_[front_];
    return is_set_forward(stamped, waited) && median(delays_from(i)) - min_delay_before() < (waited - stamped) / 2;
  }

  bool is_backward_step(std::size_t i) const {
    constexpr std::size_t kConfirming = 5;
    const Timestamp step = backward_step_at(i);
    if (step < kMinStep || i + kConfirming > stamps_.size()) return false;
    const auto begin = stamps_.begin() + static_cast<std::ptrdiff_t>(i);
    if (!std::is_sorted(begin, begin + kConfirming)) return false;
    return received_.empty() ? step >= multiple(kContinuous, interval_) : is_delayed_from(i, step);
  }

  // Whether the items from i to `end` are late: the clock continues at `end`, and they fill gaps, or are few and not
  // very late; or they are the piece before the first item.
  bool are_late(std::size_t i, std::size_t end) const {
    const Timestamp gap_to_first = sorted_stamps_.front() - stamps_[end - 1];
    const Timestamp near = static_cast<Timestamp::rep>(kMaxRun) * interval_;
    if (end == stamps_.size()) return gap_to_first > Timestamp{} && gap_to_first <= near;
    const bool continues = received_.empty() ? is_jump(end) : !is_delayed_from(end, backward_step_at(i));
    if (!continues) return false;
    if (end - i <= kMaxRun && backward_step_at(i) <= kMaxLateness) return true;
    if (gap_to_first > near) return false;
    std::size_t filling = 0;
    for (std::size_t k = i; k < end; ++k) filling += fills_gap(stamps_[k]) ? 1 : 0;
    return 2 * filling >= end - i;
  }

  bool fills_gap(Timestamp stamp) const {
    constexpr double kMinSpacing = 0.7;  // intervals
    const auto after = std::ranges::lower_bound(sorted_stamps_, stamp);
    Timestamp nearest = Timestamp::max();
    if (after != sorted_stamps_.end()) nearest = *after - stamp;
    if (after != sorted_stamps_.begin()) nearest = std::min(nearest, stamp - *std::prev(after));
    return nearest == Timestamp{} || nearest >= multiple(kMinSpacing, interval_);
  }

  // Continuous time of item i if the clock was set immediately before it.
  Timestamp expected_at(std::size_t i) const {
    Timestamp passed = static_cast<Timestamp::rep>(i - front_) * interval_;
    if (!received_.empty()) {
      const Timestamp waited = received_[i] - received_[front_];
      const double intervals =
          std::max(1.0, std::round(static_cast<double>(waited.count()) / static_cast<double>(interval_.count())));
      passed = intervals <= static_cast<double>(kMaxRun) ? multiple(intervals, interval_) : waited;
    }
    return times_[front_] + passed;
  }

  std::size_t place(std::size_t i) {
    times_[i] = stamps_[i] - shift_;
    front_ = i;
    placed_.push_back(i);
    sorted_stamps_.push_back(stamps_[i]);
    return i + 1;
  }

  std::size_t place_late(std::size_t i, std::size_t end) {
    for (std::size_t k = i; k < end; ++k) {
      times_[k] = stamps_[k] - shift_;
      sorted_stamps_.insert(std::ranges::upper_bound(sorted_stamps_, stamps_[k]), stamps_[k]);
      ++late_;
    }
    return end;
  }

  std::size_t mark_outliers(std::size_t i, std::size_t end) {
    for (std::size_t k = i; k < end; ++k) is_outlier_[k] = true;
    return end;
  }

  std::size_t set_clock(std::size_t i, Timestamp time) {
    if (end_of_excursion_ && *end_of_excursion_ <= i) end_of_excursion_.reset();
    const Timestamp shift = stamps_[i] - time;
    steps_.push_back({i, shift - shift_});
    shift_ = shift;
    placed_.clear();
    sorted_stamps_.clear();
    return place(i);
  }

  std::size_t count_backward_steps() const {
    std::size_t count = 0;
    for (std::size_t i = 1; i < stamps_.size(); ++i) count += stamps_[i] < stamps_[i - 1] ? 1 : 0;
    return count;
  }

  // The list is unordered: a clock does not have so many steps.
  void revert_to_stamps() {
    times_ = stamps_;
    is_outlier_.assign(stamps_.size(), false);
    steps_.clear();
    late_ = static_cast<int>(count_backward_steps());
  }

  const Times& stamps_;
  const Times& received_;
  Timestamp interval_;
  bool is_order_certain_;

  Times times_;
  std::vector<bool> is_outlier_;
  Times latest_from_;  // latest stamp among the items from each one on
  std::vector<Step> steps_;
  int late_ = 0;

  Timestamp shift_{};                            // sum of the steps so far
  std::size_t front_ = 0;                        // item with the latest stamp since the last step
  std::vector<std::size_t> placed_;              // items since the last step, without late ones
  Times sorted_stamps_;                          // stamps since the last step, with late ones, in order
  std::optional<std::size_t> end_of_excursion_;  // item at which the clock returns to shift_before_
  Timestamp shift_before_{};
};

// Whether receive times have about the rate of the stamps.
bool is_at_same_rate(const Times& received, Timestamp interval) {
  const Timestamp other = typical_interval(received);
  return other > multiple(0.8, interval) && other < multiple(1.25, interval) && std::ranges::is_sorted(received);
}

Timestamp median_of_delays(const RecordedStamps& recorded, std::size_t begin, std::size_t end) {
  Times delays;
  for (std::size_t i = begin; i < end; ++i) delays.push_back(recorded.received[i] - recorded.stamps[i]);
  return median(std::move(delays));
}

// Adopts the steps of another sensor's clock if both are the same clock.
class StepAdoption {
 public:
  StepAdoption(const RecordedStamps& recorded, Timestamp interval, bool has_reception, const SensorClock& other)
      : recorded_(recorded), interval_(interval), has_reception_(has_reception), other_(other) {}

  void adopt(Times& times, std::vector<StampCorrector::Step>& steps) const {
    std::vector<bool> is_matched(steps.size(), false);
    std::vector<StampCorrector::Step> added;
    for (const SharedClockStep& shared : other_.steps) {
      std::size_t own = 0;
      while (own < steps.size() && (is_matched[own] || !is_same(steps[own], shared))) ++own;
      if (own < steps.size()) {
        shift_from(steps[own].item, shared.by - steps[own].by, times);
        steps[own].by = shared.by;
        is_matched[own] = true;
      } else if (const auto item = first_item_after(shared)) {
        shift_from(*item, shared.by, times);
        added.push_back({*item, shared.by});
      }
    }
    steps.insert(steps.end(), added.begin(), added.end());
    std::ranges::sort(steps, {}, &StampCorrector::Step::item);
  }

 private:
  static void shift_from(std::size_t item, Timestamp by, Times& times) {
    for (std::size_t i = item; i < times.size(); ++i) times[i] -= by;
  }

  bool is_same(const StampCorrector::Step& own, const SharedClockStep& shared) const {
    const Timestamp tolerance = 2 * (interval_ + other_.interval) + 50ms;
    if (std::chrono::abs(own.by - shared.by) > tolerance) return false;
    return !shared.received || recorded_.received.empty() ||
           std::chrono::abs(recorded_.received[own.item] - *shared.received) <= 2s;
  }

  // First item after a step that is too short for the interval of these items, by reception delays; empty without one.
  std::optional<std::size_t> first_item_after(const SharedClockStep& shared) const {
    constexpr std::size_t kLeast = 5;
    if (!has_reception_ || !shared.received) return std::nullopt;
    const Times& received = recorded_.received;
    auto item = static_cast<std::size_t>(std::ranges::lower_bound(received, *shared.received) - received.begin());
    if (item < kLeast || received.size() - item < kLeast) return std::nullopt;
    const Timestamp before = median_of_delays(recorded_, item - std::min(item, kWindow), item);
    const Timestamp after = median_of_delays(recorded_, item, std::min(item + kWindow, received.size()));
    if (std::chrono::abs(after - before + shared.by) >= std::chrono::abs(shared.by) / 2) return std::nullopt;
    while (item > 1) {  // the first item of the other sensor after the step may be later than that of this one
      const Timestamp delay = received[item - 1] - recorded_.stamps[item - 1];
      if (std::chrono::abs(delay - after) > std::chrono::abs(delay - before)) break;
      --item;
    }
    return item;
  }

  const RecordedStamps& recorded_;
  Timestamp interval_;
  bool has_reception_;
  const SensorClock& other_;
};

// Sorts by time and keeps the first item of each time.
void keep_in_order(const Times& times, RestoredTimes& result) {
  result.times_of_all = times;
  std::vector<std::size_t> items(times.size());
  std::iota(items.begin(), items.end(), std::size_t{0});
  std::ranges::stable_sort(items, {}, [&](std::size_t item) { return times[item]; });
  const auto repeated = std::ranges::unique(items, {}, [&](std::size_t item) { return times[item]; });
  result.corrections.repeated = static_cast<int>(repeated.size());
  items.erase(repeated.begin(), repeated.end());
  for (const std::size_t item : items) result.times.push_back(times[item]);
  result.items = std::move(items);
}

RestoredTimes use_receive_times(const RecordedStamps& recorded) {
  RestoredTimes result;
  result.corrections.source = result.clock.source = TimeSource::receive_times;
  result.clock.interval = typical_interval(recorded.received);
  keep_in_order(recorded.received, result);
  return result;
}

}  // namespace

RestoredTimes restore_times(const RecordedStamps& recorded, const SensorClock& other) {
  const std::size_t size = recorded.stamps.size();
  const bool can_use_reception = recorded.received.size() == size && are_mostly_distinct(recorded.received);
  std::vector<std::size_t> stamped;
  Times stamps, received;
  const std::vector<bool> are_stamped = find_stamped(recorded.stamps);
  for (std::size_t i = 0; i < size; ++i) {
    if (!are_stamped[i]) continue;
    stamped.push_back(i);
    stamps.push_back(recorded.stamps[i]);
    if (!recorded.received.empty()) received.push_back(recorded.received[i]);
  }
  const bool are_coarse = is_coarse(stamps) && !(can_use_reception && are_all_repeated(stamps, received));
  const bool are_unusable = are_coarse || 2 * stamped.size() < size || other.source == TimeSource::receive_times;
  if (can_use_reception && are_unusable) return use_receive_times(recorded);

  RestoredTimes result;
  Times times = recorded.stamps;
  std::vector<StampCorrector::Step> steps;
  if (!stamps.empty()) {
    if (are_coarse) {
      stamps = spread_evenly(stamps);
      result.corrections.source = result.clock.source = TimeSource::even_spacing;
    }
    const Timestamp interval = result.clock.interval = typical_interval(stamps);
    const bool has_reception = can_use_reception && is_at_same_rate(received, interval);
    if (!has_reception) received.clear();
    const StampCorrector line(stamps, received, interval, recorded.is_order_certain);
    std::vector<bool> has_time(size, false);
    for (std::size_t i = 0; i < stamped.size(); ++i) {
      times[stamped[i]] = line.times()[i];
      has_time[stamped[i]] = !line.is_outlier()[i];
    }
    for (const StampCorrector::Step& step : line.steps()) steps.push_back({stamped[step.item], step.by});
    result.corrections.late = line.late();
    result.corrections.unstamped = static_cast<int>(std::ranges::count(has_time, false));
    interpolate_gaps(times, has_time, interval);
    StepAdoption(recorded, interval, has_reception, other).adopt(times, steps);
  }
  keep_in_order(times, result);
  for (const auto& [item, by] : steps) {
    const auto first = std::ranges::lower_bound(result.times, times[item]);
    result.corrections.clock_steps.push_back({static_cast<int>(first - result.times.begin()), by});
    const auto when = recorded.received.empty() ? std::nullopt : std::optional(recorded.received[item]);
    result.clock.steps.push_back({by, when});
  }
  return result;
}

std::string_view to_string(TimeSource source) {
  return name_among<TimeSource::even_spacing>({"stamps", "receive times", "even spacing"}, source);
}

std::vector<std::string> describe(const TimeCorrections& corrections, const ItemNames& names) {
  std::vector<std::string> lines;
  const std::string items = names.kind + "s";
  const auto add = [&](const std::string& text) { lines.push_back(names.place + ": " + text); };
  if (corrections.source == TimeSource::receive_times) {
    add("time stamps are zero or in whole seconds; receive times are used for all " + items);
  } else if (corrections.source == TimeSource::even_spacing) {
    add("time stamps are in whole seconds; the " + items + " of each time stamp are spread evenly");
  }
  constexpr std::size_t kMaxListed = 10;
  const auto& steps = corrections.clock_steps;
  for (std::size_t i = 0; i < std::min(steps.size(), kMaxListed); ++i) {
    const double by = to_seconds(steps[i].by);
    add(fmt::format("clock set {} by {:.3f} s at {} {}: later times are shifted to continue",
                    by < 0.0 ? "back" : "forward", std::abs(by), names.counted, steps[i].frame));
  }
  if (steps.size() > kMaxListed) add(std::to_string(steps.size() - kMaxListed) + " more clock steps");
  const auto add_count = [&](int count, const std::string& text) {
    if (count > 0) add(std::to_string(count) + " " + items + " " + text);
  };
  add_count(corrections.unstamped, "have a zero or wrong time stamp: times are interpolated");
  add_count(corrections.late, "were recorded after later ones: sorted by time");
  add_count(corrections.repeated, "have the time stamp of another one: ignored");
  return lines;
}

}  // namespace byre
