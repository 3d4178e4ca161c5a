#pragma once

#include "byre/io/ros/messages.h"
#include "byre/ros2/dds/participant.h"
#include "byre/ros2/node/process.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Input topic of a node, and its subscription.
struct WatchedInput {
  std::string name;                // "left images"
  std::string topic;               // full name
  std::vector<std::string> types;  // accepted types
  TopicQos qos;
  bool is_once = false;                                     // one message is sufficient
  std::string remedy_for_type{};                            // setting for publishers of another type
  std::string remedy_for_reliability{};                     // setting for best-effort publishers
  std::function<int()> matched = [] { return 0; };          // publishers connected by DDS
  std::function<std::string()> detail = [] { return ""; };  // further fact on missing messages
};

// Topic that only this node should publish.
struct WatchedOutput {
  std::string topic;   // full name
  std::string remedy;  // for a second publisher
};

// Reports inputs without messages for 5 s, with the publishers of their topics, and outputs that other nodes publish as
// well for 15 s. Time during which the node does not read messages, as while it loads a map, does not count.
class InputMonitor {
 public:
  using Id = std::size_t;
  using Discovered = std::function<std::vector<DiscoveredPublisher>(const std::string& topic)>;

  // discovered: publishers on a topic. now: start time, of a steady clock.
  InputMonitor(Discovered discovered, Timestamp now) : discovered_(std::move(discovered)), last_check_(now) {}

  Id add(WatchedInput input);
  void add(WatchedOutput output) { outputs_.push_back({std::move(output)}); }
  void note_arrival(Id id) { inputs_[id].has_arrived = true; }
  // Inputs are needed unless stated otherwise. Silence counts from the time when an input is needed again.
  void set_needed(Id id, bool is_needed);

  // One warning for each input that becomes silent, or whose unsuitable publishers change meanwhile, and for each
  // output with a second publisher; one information when that is over.
  std::vector<LogLine> check(Timestamp now);

  // Findings of the last check.
  ros::DiagnosticStatus status() const;

 private:
  struct Watch {
    WatchedInput input;
    bool is_needed = true;
    bool has_arrived = false;   // since the last check
    bool ever_arrived = false;  // since the start
    Timestamp since{};          // last arrival, by clock_
    std::string finding{};      // empty unless silent
    std::string reported{};     // unsuitable publishers in the last warning
  };
  struct Rivals {
    WatchedOutput output;
    std::optional<Timestamp> since{};  // first check with another publisher, by clock_
    std::string finding{};             // empty without a second publisher
  };
  void check(Watch& watch, std::vector<LogLine>& lines);
  void check(Rivals& rivals, std::vector<LogLine>& lines);

  Discovered discovered_;  // constant after construction
  Timestamp last_check_;
  Timestamp clock_{};  // time during which messages were read
  std::vector<Watch> inputs_;
  std::vector<Rivals> outputs_;
};

}  // namespace byre
