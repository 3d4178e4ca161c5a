#include "mission_plan.h"

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

Timestamp MissionPlan::disturbed_from() const {
  const auto first = std::ranges::find_if(steps, [](const MissionStep& step) { return step.disturb != nullptr; });
  return first != steps.end() ? first->time : steps.front().time;
}

MissionPlan as_recorded(const std::vector<Timestamp>& times) {
  MissionPlan plan;
  for (std::size_t i = 0; i < times.size(); ++i) plan.steps.push_back({static_cast<int>(i), times[i], {}});
  plan.undisturbed_from = times.front();
  return plan;
}

MissionPlan degraded(const std::vector<Timestamp>& times, const Span& span, const Degradation& degradation) {
  MissionPlan plan = as_recorded(times);
  const std::vector<int> frames = frames_in(times, span);
  assert(!frames.empty());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    plan.steps[static_cast<std::size_t>(frames[i])].disturb = at_step(degradation, static_cast<int>(i));
  }
  const std::size_t next = static_cast<std::size_t>(frames.back()) + 1;
  plan.undisturbed_from = next < times.size() ? std::optional(times[next]) : std::nullopt;
  return plan;
}

MissionPlan kidnapped(const std::vector<Timestamp>& times, const Span& before, const Span& after, double dark_seconds) {
  const std::vector<int> first = frames_in(times, before), second = frames_in(times, after);
  assert(first.size() > 1 && !second.empty());
  MissionPlan plan;
  const Timestamp dark_from = times[static_cast<std::size_t>(first.back())] - from_seconds(dark_seconds);
  int dark_steps = 0;
  for (const int frame : first) {
    const Timestamp time = times[static_cast<std::size_t>(frame)];
    plan.steps.push_back({frame, time, {}});
    if (time > dark_from) plan.steps.back().disturb = at_step(black_frames(), dark_steps++);
  }
  const Timestamp interval = plan.steps.back().time - plan.steps[plan.steps.size() - 2].time;
  const Timestamp set_down = plan.steps.back().time + interval;
  const Timestamp delay = set_down - times[static_cast<std::size_t>(second.front())];
  for (const int frame : second) plan.steps.push_back({frame, times[static_cast<std::size_t>(frame)] + delay, {}});
  plan.undisturbed_from = set_down;
  return plan;
}

MissionPlan repeated(const std::vector<Timestamp>& times, int times_each) {
  MissionPlan plan = as_recorded(times);
  for (MissionStep& step : plan.steps) step.frame -= step.frame % times_each;
  return plan;
}

MissionPlan dropped(const std::vector<Timestamp>& times, int kept_every) {
  MissionPlan plan = as_recorded(times);
  std::erase_if(plan.steps, [&](const MissionStep& step) { return step.frame % kept_every != 0; });
  return plan;
}

MissionPlan late(const std::vector<Timestamp>& times, const Span& span, double jump_seconds) {
  MissionPlan plan = as_recorded(times);
  Timestamp last = times.front();
  for (MissionStep& step : plan.steps) {
    if (contains(span, step.time - times.front())) step.time += from_seconds(jump_seconds);
    step.time = std::max(step.time, last + Timestamp(1));
    last = step.time;
  }
  return plan;
}

}  // namespace byre
