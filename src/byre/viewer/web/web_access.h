#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Access rules of a web server.
struct WebAccess {
  std::vector<std::string> host_names;  // accepted host names, without port; empty: any
  std::string token;                    // required query parameter ("?token=..."); empty: none
};

// Access for a bound address. On loopback: any local client, with a loopback host name, which prevents DNS rebinding.
// On the network: clients with the token.
WebAccess access_to(const std::string& bound_address);

// Whether the address is in 127.0.0.0/8 or ::1.
bool is_loopback(const std::string& address);

// 128 random bits from the system, as hexadecimal digits.
std::string make_token();

// Origin of a request; fields of missing headers are empty.
struct WebOrigin {
  std::string_view host;     // header Host
  std::string_view origin;   // header Origin: page of the request, sent by browsers
  std::string_view target;   // path and query
  bool is_foxglove = false;  // request for Foxglove's protocol
};

// Reason for rejecting a request; empty if accepted. Requests of pages must come from byre's own page. Foxglove's
// protocol is also accepted from Foxglove's applications, local servers and files; over the network with the token.
// Tokens are compared in constant time.
std::string_view rejection_reason(const WebAccess& access, const WebOrigin& from);

// Parts of a target: path before the "?", and value of a query parameter or empty.
std::string_view path_of(std::string_view target);
std::string_view query_value(std::string_view target, std::string_view name);

// Addresses at which a server is reachable. For 0.0.0.0 and ::, the addresses of all interfaces, loopback last; else
// the bound address.
std::vector<std::string> reachable_addresses(const std::string& bound_address);

// Limits of connections, for the benefit of the program's main task. A connection is pending until a request of it is
// accepted. Anyone who reaches the port can open one, so pending connections are few and time out soon.
struct WebLimits {
  int accepted = 48;                                // largest number of accepted connections
  int pending = 16;                                 // largest number of pending connections
  std::chrono::milliseconds request_timeout{3000};  // time for the first request, from the connection on
  // Rate of accepting connections. The kernel queues further ones, and rejects them if its queue is full.
  double accepts_per_second = 300.0;
  int accept_burst = 64;          // burst of accepted connections
  int reserved_descriptors = 32;  // file descriptors reserved for the program; at most half of all
};

// Connections of a web server, and which to close above the limits. A new pending connection displaces the oldest
// one of the address with most of them, so that prompt requests are served however many connections idle.
class ConnectionTable {
 public:
  using Id = std::uint64_t;

  explicit ConnectionTable(const WebLimits& limits) : limits_(limits) {}

  struct Admission {
    Id id = 0;
    std::optional<Id> to_close;  // connection to close in exchange; possibly the new one
  };
  Admission open(const std::string& address);

  // Marks a connection as accepted. False: too many accepted connections.
  bool accept(Id id);

  void close(Id id);

  int pending() const { return static_cast<int>(pending_.size()); }
  int accepted() const { return accepted_; }

 private:
  Id oldest_of_busiest_address() const;

  WebLimits limits_;                   // constant after construction
  std::map<Id, std::string> pending_;  // addresses of pending connections; ids ascend, so the oldest is first
  int accepted_ = 0;
  Id next_ = 1;
};

// Entry of a connection in a ConnectionTable, released on destruction.
class ConnectionSlot {
 public:
  // The table outlives this.
  ConnectionSlot(ConnectionTable& table, ConnectionTable::Id id) : table_(table), id_(id) {}
  ~ConnectionSlot() { table_.close(id_); }
  ConnectionSlot(const ConnectionSlot&) = delete;
  ConnectionSlot& operator=(const ConnectionSlot&) = delete;

  bool accept() { return table_.accept(id_); }

 private:
  ConnectionTable& table_;
  ConnectionTable::Id id_;
};

// Token bucket that limits accepted connections.
class AcceptLimiter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  AcceptLimiter(const WebLimits& limits, Time now)
      : per_second_(limits.accepts_per_second), most_(limits.accept_burst), left_(most_), last_(now) {}

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
