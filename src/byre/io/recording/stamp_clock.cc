#include "byre/io/recording/stamp_clock.h"

#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace byre {
namespace {

// Consecutive items with one stamp.
struct StampRun {
  std::size_t begin = 0;
  Timestamp::rep size = 0;
};

std::vector<StampRun> runs_of(const std::vector<Timestamp>& stamps) {
  std::vector<StampRun> runs;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (i > 0 && stamps[i] == stamps[i - 1]) {
      ++runs.back().size;
    } else {
      runs.push_back({i, 1});
    }
  }
  return runs;
}

}  // namespace

Timestamp multiple(double factor, Timestamp interval) {
  return Timestamp(std::llround(factor * static_cast<double>(interval.count())));
}

Timestamp typical_interval(const std::vector<Timestamp>& stamps) {
  std::vector<Timestamp> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) intervals.push_back(stamps[i] - stamps[i - 1]);
  }
  return median_or(std::move(intervals), Timestamp{});
}

bool is_coarse(const std::vector<Timestamp>& stamps) {
  constexpr std::size_t kLeast = 6;  // items; fewer may be repeated by chance
  return stamps.size() >= kLeast && !are_mostly_distinct(stamps);
}

bool are_mostly_distinct(const std::vector<Timestamp>& stamps) {
  return 2 * stamps.size() < 3 * runs_of(stamps).size();
}

bool are_all_repeated(const std::vector<Timestamp>& stamps, const std::vector<Timestamp>& received) {
  if (received.size() != stamps.size()) return false;
  std::vector<Timestamp> within, between;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    (stamps[i] == stamps[i - 1] ? within : between).push_back(received[i] - received[i - 1]);
  }
  return !within.empty() && !between.empty() && 4 * median(within) < median(between);
}

std::vector<Timestamp> spread_evenly(const std::vector<Timestamp>& stamps) {
  const std::vector<StampRun> runs = runs_of(stamps);
  std::vector<Timestamp> starts;
  for (const StampRun& run : runs) starts.push_back(stamps[run.begin]);
  const Timestamp resolution = typical_interval(starts);
  const auto step_after = [&](std::size_t run) { return starts[run + 1] - starts[run]; };
  const auto is_whole = [&](std::size_t run) {
    return run > 0 && run + 1 < runs.size() && step_after(run) > Timestamp{} &&
           step_after(run) <= multiple(1.5, resolution);
  };
  std::vector<Timestamp> intervals;
  Timestamp::rep largest = 1;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    largest = std::max(largest, runs[run].size);
    if (is_whole(run)) intervals.push_back(step_after(run) / runs[run].size);
  }
  const Timestamp usual = median_or(std::move(intervals), resolution / largest);
  std::vector<Timestamp> spread;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const Timestamp::rep size = runs[run].size;
    const Timestamp interval = is_whole(run) ? step_after(run) / size : usual;
    const bool ends_with_next = run == 0 && runs.size() > 1 && step_after(0) > Timestamp{};
    const Timestamp begin = ends_with_next ? starts[1] - size * interval : starts[run];
    for (Timestamp::rep i = 0; i < size; ++i) spread.push_back(begin + i * interval);
  }
  return spread;
}

void interpolate_gaps(std::vector<Timestamp>& times, const std::vector<bool>& has_time, Timestamp interval) {
  const std::size_t size = times.size();
  for (std::size_t begin = 0; begin < size;) {
    if (has_time[begin]) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (end < size && !has_time[end]) ++end;
    const auto count = static_cast<Timestamp::rep>(end - begin);
    const bool is_between = begin > 0 && end < size;
    const Timestamp step = is_between ? (times[end] - times[begin - 1]) / (count + 1) : interval;
    const Timestamp before = begin > 0 ? times[begin - 1] : times[end] - (count + 1) * step;
    for (std::size_t i = begin; i < end; ++i) times[i] = before + static_cast<Timestamp::rep>(i - begin + 1) * step;
    begin = end;
  }
}

StampClock::Reading StampClock::read(Timestamp stamp, Timestamp arrival) {
  constexpr Timestamp kShortest = std::chrono::milliseconds(1);  // least time between the images around a step
  const Last last = last_.value_or(Last{stamp, arrival});
  last_ = Last{stamp, arrival};
  const Timestamp received = std::max(arrival - last.arrival, kShortest);
  const Timestamp stamped = stamp - last.stamp;
  if (stamped >= -kMaxLateness && !is_set_forward(stamped, received)) return {stamp - jumped_, std::nullopt};
  const Timestamp jump = stamped - received;
  jumped_ += jump;
  return {stamp - jumped_, jump};
}

}  // namespace byre
