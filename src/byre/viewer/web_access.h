#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Who may ask a web server for anything.
struct WebAccess {
  std::vector<std::string> host_names;  // names that the server may be called by, without the port; empty: any
  std::string token;                    // value that the query of each request must hold ("?token=..."); empty: none
};

// On loopback anybody on this machine may ask, by the names of loopback alone: a page from elsewhere whose name was
// made to lead here (DNS rebinding) is refused. Opened to the network, whoever knows the token may.
WebAccess access_to(const std::string& bound_address);

// Whether the address is in 127.0.0.0/8 or ::1.
bool is_loopback(const std::string& address);

// 128 bits from the system's source of randomness, as hexadecimal digits.
std::string make_token();

// What a request says of where it comes from; header fields are empty when they are missing.
struct WebOrigin {
  std::string_view host;     // header Host
  std::string_view origin;   // header Origin: sent by browsers, names the page that asks
  std::string_view target;   // path and query
  bool is_foxglove = false;  // whether it asks to speak Foxglove's protocol
};

// A page that asks must be byre's own. Foxglove's protocol is also spoken with the applications that know it: those of
// Foxglove and those that this machine serves or has as files; through the network with whoever has the token.
//
// Why a request is refused, for whoever reads it in a browser; empty when it is not. Tokens are compared in a time that
// tells nothing of them.
std::string_view refusal(const WebAccess& access, const WebOrigin& from);

// The parts of a target: what is before the "?", and the value of a name after it, or nothing.
std::string_view path_of(std::string_view target);
std::string_view query_value(std::string_view target, std::string_view name);

}  // namespace byre
