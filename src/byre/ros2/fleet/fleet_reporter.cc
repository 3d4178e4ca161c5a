#include "byre/ros2/fleet/fleet_reporter.h"

#include <utility>

namespace byre {
namespace {

constexpr Timestamp kMaxBetweenStates = std::chrono::seconds(30);

std::string summary_of(const FleetPosition& position, const FleetMap& map) {
  return std::string(position.is_initialised ? "known " : "unknown ")
      .append(position.problem)
      .append(" ")
      .append(map.id);
}

}  // namespace

FleetReporter::FleetReporter(const FleetIdentity& identity, double rate, Send send)
    : identity_(identity), interval_(from_seconds(1.0 / rate)), send_(std::move(send)) {}

bool FleetReporter::is_state_due(const std::string& summary, Timestamp now, int connections) const {
  if (!state_ || connections != connections_ || now - state_->at >= kMaxBetweenStates) return true;
  return summary != state_->summary && now - state_->at >= interval_;
}

void FleetReporter::publish(const FleetPosition& position, const FleetMap& map, Timestamp now, WallTime wall,
                            int connections) {
  if (connections == 0) return;
  if (std::string summary = summary_of(position, map); is_state_due(summary, now, connections)) {
    send_({fleet_topic(identity_, "state"), state_text(identity_, {states_++, wall}, position, map)});
    state_ = SentState{now, std::move(summary)};
    connections_ = connections;
  }
  if (visualization_ && now - *visualization_ < interval_) return;
  send_({fleet_topic(identity_, "visualization"),
         visualization_text(identity_, {visualizations_++, wall}, position, map)});
  visualization_ = now;
}

}  // namespace byre
