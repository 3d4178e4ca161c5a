#pragma once

#include <string>
#include <vector>

namespace byre {

// Addresses at which a server is reachable. For 0.0.0.0 and ::, the addresses of all interfaces, loopback last; else
// the bound address.
std::vector<std::string> reachable_addresses(const std::string& bound_address);

}  // namespace byre
