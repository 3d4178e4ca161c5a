#include "byre/ros2/node/input_monitor.h"

#include "byre/base/printable.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using std::chrono_literals::operator""s;

constexpr Timestamp kLongestWithoutMessage = 5s;
constexpr Timestamp kLongestWithRivals = 15s;  // DDS keeps publishers of a crashed process for 10 s
constexpr Timestamp kLongestStep = 1s;         // between two checks while messages are read

std::string publishers_text(int count) {
  return fmt::format("{} publisher{}", count, count == 1 ? "" : "s");
}

std::string qos_text(bool is_reliable, bool is_latched) {
  return std::string(is_reliable ? "reliable" : "best effort") + (is_latched ? ", transient local" : ", volatile");
}

std::string list_of(const std::vector<std::string>& types) {
  std::string text;
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (i > 0) text += i + 1 == types.size() ? " or " : ", ";
    text += types[i];
  }
  return text;
}

// Reason why DDS does not connect a publisher, with a remedy; empty if it suits.
std::string mismatch(const WatchedInput& input, const DiscoveredPublisher& publisher) {
  constexpr std::size_t kShownOfType = 80;
  const auto with = [](const std::string& remedy) { return remedy.empty() ? "" : "; " + remedy; };
  if (std::ranges::find(input.types, publisher.type) == input.types.end()) {
    const std::string type = publisher.type.empty() ? "not of ROS" : printable(publisher.type, kShownOfType);
    return "type " + type + ", required " + list_of(input.types) + with(input.remedy_for_type);
  }
  const bool lacks_reliability = input.qos.is_reliable && !publisher.is_reliable;
  if (!lacks_reliability && (!input.qos.is_latched || publisher.is_latched)) return "";
  return "QoS " + qos_text(publisher.is_reliable, publisher.is_latched) + ", required " +
         qos_text(input.qos.is_reliable, input.qos.is_latched) +
         (lacks_reliability ? with(input.remedy_for_reliability) : "");
}

// Unsuitable publishers, each reason once; empty without one.
std::string mismatches(const WatchedInput& input, const std::vector<DiscoveredPublisher>& publishers) {
  std::vector<std::pair<std::string, int>> counts;
  for (const DiscoveredPublisher& publisher : publishers) {
    const std::string reason = mismatch(input, publisher);
    if (reason.empty()) continue;
    const auto known = std::ranges::find(counts, reason, &std::pair<std::string, int>::first);
    if (known != counts.end()) ++known->second;
    if (known == counts.end()) counts.emplace_back(reason, 1);
  }
  std::ranges::sort(counts);  // discovery has no order
  std::string text;
  for (const auto& [reason, count] : counts) {
    text += (text.empty() ? "" : "; ") + publishers_text(count) + " not connected: " + reason;
  }
  return text;
}

std::string connected_text(int matched, bool has_mismatches) {
  if (matched > 0) return publishers_text(matched) + " connected, without a message; check that it runs";
  return has_mismatches ? "" : "no publisher; check its program, the topic and ROS_DOMAIN_ID";
}

std::string joined(const std::string& first, const std::string& second) {
  return first + (first.empty() || second.empty() ? "" : "; ") + second;
}

}  // namespace

InputMonitor::Id InputMonitor::add(WatchedInput input) {
  inputs_.push_back({std::move(input)});
  inputs_.back().since = clock_;
  return inputs_.size() - 1;
}

void InputMonitor::set_needed(Id id, bool is_needed) {
  Watch& watch = inputs_[id];
  if (std::exchange(watch.is_needed, is_needed) == is_needed) return;
  watch.since = clock_;
  if (!is_needed) watch.finding.clear();
}

std::vector<LogLine> InputMonitor::check(Timestamp now) {
  const Timestamp passed = now - std::exchange(last_check_, now);
  clock_ += std::clamp(passed, Timestamp{}, kLongestStep);
  std::vector<LogLine> lines;
  for (Watch& watch : inputs_) check(watch, lines);
  for (Rivals& rivals : outputs_) check(rivals, lines);
  return lines;
}

void InputMonitor::check(Watch& watch, std::vector<LogLine>& lines) {
  const WatchedInput& input = watch.input;
  if (std::exchange(watch.has_arrived, false)) {
    watch.ever_arrived = true;
    watch.since = clock_;
    if (!watch.finding.empty()) lines.push_back({LogLevel::info, input.name + " received on " + input.topic});
    watch.finding.clear();
    return;
  }
  const bool is_satisfied = !watch.is_needed || (input.is_once && watch.ever_arrived);
  if (is_satisfied || clock_ - watch.since < kLongestWithoutMessage) return;
  const std::string unsuitable = mismatches(input, discovered_(input.topic));
  const int matched = input.matched();
  const std::string facts = joined(joined(connected_text(matched, !unsuitable.empty()), unsuitable), input.detail());
  const bool was_silent = !watch.finding.empty();
  watch.finding = "no " + input.name + " on " + input.topic + " for 5 s: " + facts;
  // A publisher that was started later, and does not suit, is a new reason; others soon send messages.
  const bool is_new_reason = !unsuitable.empty() && unsuitable != watch.reported;
  if (was_silent && !is_new_reason) return;
  watch.reported = unsuitable;
  lines.push_back({LogLevel::warning, watch.finding});
}

void InputMonitor::check(Rivals& rivals, std::vector<LogLine>& lines) {
  const std::string& topic = rivals.output.topic;
  const auto count = static_cast<int>(discovered_(topic).size());
  if (count == 0) {
    if (!rivals.finding.empty()) lines.push_back({LogLevel::info, "no other node publishes " + topic + " any more"});
    rivals.finding.clear();
    rivals.since.reset();
    return;
  }
  if (!rivals.since) rivals.since = clock_;
  if (!rivals.finding.empty() || clock_ - *rivals.since < kLongestWithRivals) return;
  rivals.finding = topic + " has a second publisher, of another node: " + rivals.output.remedy;
  lines.push_back({LogLevel::warning, rivals.finding});
}

ros::DiagnosticStatus InputMonitor::status() const {
  ros::DiagnosticStatus status;
  status.name = "byre: inputs";
  for (const Watch& watch : inputs_) {
    const WatchedInput& input = watch.input;
    const bool is_silent = !watch.finding.empty();
    if (is_silent) {
      status.level = ros::DiagnosticStatus::kWarn;
      status.message = joined(status.message, watch.finding);
    }
    const char* const state = is_silent            ? "silent"
                              : !watch.is_needed   ? "not needed"
                              : watch.ever_arrived ? "arrived"
                                                   : "waiting";
    status.values.push_back({input.name + " on " + input.topic, state});
  }
  for (const Rivals& rivals : outputs_) {
    if (rivals.finding.empty()) continue;
    status.level = ros::DiagnosticStatus::kWarn;
    status.message = joined(status.message, rivals.finding);
  }
  if (status.message.empty()) status.message = "no input is missing";
  return status;
}

}  // namespace byre
