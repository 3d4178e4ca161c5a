#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Limits of connections, for the benefit of the program's main task. A stranger is a connection without an accepted
// request. Anyone who reaches the port can open one, so strangers are few and have little time.
struct WebLimits {
  int known = 48;                            // largest number of accepted connections
  int strangers = 16;                        // largest number of strangers
  std::chrono::milliseconds patience{3000};  // time for the first request, from the connection on
  // Rate of accepting connections. The kernel queues further ones, and rejects them if its queue is full.
  double arrivals_per_second = 300.0;
  int arrivals_at_once = 64;  // burst of accepted connections
  int free_descriptors = 32;  // file descriptors reserved for the program; at most half of all
};

// Connections of a web server, and which to close above the limits. A new stranger displaces the oldest one of the
// address with most strangers, so that prompt requests are served however many connections idle.
class WebGuests {
 public:
  using Id = std::uint64_t;

  explicit WebGuests(const WebLimits& limits) : limits_(limits) {}

  struct Arrival {
    Id id = 0;
    std::optional<Id> to_close;  // connection to close in exchange; possibly the new one
  };
  Arrival arrive(const std::string& address);

  // Marks a connection as accepted. False: too many accepted connections.
  bool introduce(Id id);

  void leave(Id id);

  int strangers() const { return static_cast<int>(strangers_.size()); }
  int known() const { return known_; }

 private:
  Id oldest_of_the_most() const;

  WebLimits limits_;                     // constant after construction
  std::map<Id, std::string> strangers_;  // addresses of strangers; ids ascend, so the oldest is first
  int known_ = 0;
  Id next_ = 1;
};

// Token bucket that limits accepted connections.
class ArrivalRate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  ArrivalRate(const WebLimits& limits, Time now)
      : per_second_(limits.arrivals_per_second), most_(limits.arrivals_at_once), left_(most_), last_(now) {}

  void count(Time now);

  // Time until the next connection may be accepted; zero: now.
  std::chrono::milliseconds wait(Time now) const;

 private:
  double left_at(Time now) const;

  double per_second_;  // constant after construction
  double most_;        // constant after construction
  double left_;        // connections available at time last_
  Time last_;
};

// Bound for new descriptors that keeps the reserved number free. The system assigns the lowest free number, so a new
// descriptor's number counts those in use.
int end_of_descriptors(const WebLimits& limits);

}  // namespace byre
