#include "mission.h"

#include <algorithm>
#include <cassert>

namespace byre {
namespace {

bool contains(const Span& span, Timestamp since_start) {
  const double seconds = to_seconds(since_start);
  return span.start <= seconds && seconds < span.end;
}

std::vector<int> frames_in(const std::vector<Timestamp>& times, const Span& span) {
  std::vector<int> frames;
  for (int i = 0; i < static_cast<int>(times.size()); ++i) {
    if (contains(span, times[static_cast<std::size_t>(i)] - times.front())) frames.push_back(i);
  }
  return frames;
}

std::function<ImageFrame(const ImageFrame&)> at_step(const Degradation& degradation, int step) {
  return [degradation, step](const ImageFrame& images) { return degradation(images, step); };
}

}  // namespace

Mission as_recorded(const std::vector<Timestamp>& times) {
  Mission mission;
  for (std::size_t i = 0; i < times.size(); ++i) mission.steps.push_back({static_cast<int>(i), times[i], {}});
  mission.undisturbed_from = times.front();
  return mission;
}

Mission degraded(const std::vector<Timestamp>& times, const Span& span, const Degradation& degradation) {
  Mission mission = as_recorded(times);
  const std::vector<int> frames = frames_in(times, span);
  assert(!frames.empty());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    mission.steps[static_cast<std::size_t>(frames[i])].disturb = at_step(degradation, static_cast<int>(i));
  }
  const std::size_t next = static_cast<std::size_t>(frames.back()) + 1;
  mission.undisturbed_from = next < times.size() ? std::optional(times[next]) : std::nullopt;
  return mission;
}

Mission kidnapped(const std::vector<Timestamp>& times, const Span& before, const Span& after, double dark_seconds) {
  const std::vector<int> first = frames_in(times, before), second = frames_in(times, after);
  assert(first.size() > 1 && !second.empty());
  Mission mission;
  const Timestamp dark_from = times[static_cast<std::size_t>(first.back())] - from_seconds(dark_seconds);
  int dark_steps = 0;
  for (const int frame : first) {
    const Timestamp time = times[static_cast<std::size_t>(frame)];
    mission.steps.push_back({frame, time, {}});
    if (time > dark_from) mission.steps.back().disturb = at_step(black_frames(), dark_steps++);
  }
  const Timestamp interval = mission.steps.back().time - mission.steps[mission.steps.size() - 2].time;
  const Timestamp set_down = mission.steps.back().time + interval;
  const Timestamp delay = set_down - times[static_cast<std::size_t>(second.front())];
  for (const int frame : second) mission.steps.push_back({frame, times[static_cast<std::size_t>(frame)] + delay, {}});
  mission.undisturbed_from = set_down;
  return mission;
}

}  // namespace byre
