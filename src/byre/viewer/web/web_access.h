#pragma once

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

}  // namespace byre
