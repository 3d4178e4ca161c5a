#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// What connections may take of a program that has more important things to do. A stranger is a connection that has not
// yet asked for anything it may have: anybody who reaches the port can open one, so there are few of them, not for
// long.
struct WebLimits {
  int known = 48;                            // connections at a time that are no strangers
  int strangers = 16;                        // strangers at a time
  std::chrono::milliseconds patience{3000};  // time that a stranger has to ask, from when it came
  // Connections let in. More wait in the kernel, and are turned away there where they are too many.
  double arrivals_per_second = 300.0;
  int arrivals_at_once = 64;  // connections let in at once after a while without any
  int free_descriptors = 32;  // descriptors left to the program, or half of all where it may have few
};

// Who is connected to a web server, and who has to go when there are too many. Strangers make room for strangers: of
// the address that has the most of them the oldest goes, so that whoever asks at once is answered however many others
// only wait.
class WebGuests {
 public:
  using Id = std::uint64_t;

  explicit WebGuests(const WebLimits& limits) : limits_(limits) {}

  struct Arrival {
    Id id = 0;
    std::optional<Id> to_close;  // whoever makes room; perhaps the one that has come
  };
  Arrival arrive(const std::string& address);

  // It has asked for what it may have, and is no stranger any more; false: there are too many known ones.
  bool introduce(Id id);

  void leave(Id id);

  int strangers() const { return static_cast<int>(strangers_.size()); }
  int known() const { return known_; }

 private:
  Id oldest_of_the_most() const;

  WebLimits limits_;                     // constant after construction
  std::map<Id, std::string> strangers_;  // addresses of strangers; ids grow, so the oldest comes first
  int known_ = 0;
  Id next_ = 1;
};

// How many connections may be let in at a time: a bucket of them that fills at a steady rate.
class ArrivalRate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  ArrivalRate(const WebLimits& limits, Time now)
      : per_second_(limits.arrivals_per_second), most_(limits.arrivals_at_once), left_(most_), last_(now) {}

  void count(Time now);

  // Until the next one may come in; zero: it may now.
  std::chrono::milliseconds wait(Time now) const;

 private:
  double left_at(Time now) const;

  double per_second_;  // constant after construction
  double most_;        // constant after construction
  double left_;        // connections in the bucket at the time last_
  Time last_;
};

// The number that a new descriptor must be below to leave those free that the limits say. The system gives the lowest
// number that is free, so it tells how many are taken.
int end_of_descriptors(const WebLimits& limits);

}  // namespace byre
