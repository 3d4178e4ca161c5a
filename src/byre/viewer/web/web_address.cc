#include "byre/viewer/web/web_address.h"

#include <algorithm>
#include <array>
#include <memory>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

namespace byre {
namespace {

// Empty for other address families, and for link-local addresses, which need an interface name.
std::string text_of(const sockaddr& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.sa_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(address).sin_addr, text.data(), text.size());
  } else if (address.sa_family == AF_INET6) {
    const in6_addr& of_v6 = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
    if (!IN6_IS_ADDR_LINKLOCAL(&of_v6)) inet_ntop(AF_INET6, &of_v6, text.data(), text.size());
  }
  return text.data();
}

std::vector<std::string> addresses_of_interfaces(bool with_v6) {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(first, freeifaddrs);
  std::vector<std::string> addresses;
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || (each->ifa_flags & IFF_UP) == 0 || (each->ifa_flags & IFF_LOOPBACK) != 0) continue;
    if (each->ifa_addr->sa_family == AF_INET6 && !with_v6) continue;
    if (const std::string address = text_of(*each->ifa_addr); !address.empty()) addresses.push_back(address);
  }
  return addresses;
}

}  // namespace

std::vector<std::string> reachable_addresses(const std::string& bound_address) {
  const bool is_v6 = bound_address == "::";
  if (!is_v6 && bound_address != "0.0.0.0") return {bound_address};
  std::vector<std::string> addresses = addresses_of_interfaces(is_v6);
  addresses.push_back("127.0.0.1");
  return addresses;
}

}  // namespace byre
