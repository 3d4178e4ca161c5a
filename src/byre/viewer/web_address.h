#pragma once

#include <string>
#include <vector>

namespace byre {

// The addresses by which a server that is bound to one can be reached, those of the network first. Of 0.0.0.0 and ::,
// which no browser can open, these are the addresses of this machine's interfaces, and last that of loopback; of any
// other it is that one.
std::vector<std::string> reachable_addresses(const std::string& bound_address);

}  // namespace byre
