#include "byre/viewer/web/web_access.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/resource.h>

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

// Host name in "name:port", "[::1]:port" or "name".
std::string_view name_in(std::string_view host) {
  const std::size_t closing = host.find(']');
  if (closing != std::string_view::npos) return host.substr(0, closing + 1);
  return host.substr(0, host.find(':'));
}

bool is_own_page(const WebOrigin& from) {
  constexpr std::string_view kScheme = "http://";
  return from.origin.empty() || (from.origin.starts_with(kScheme) && from.origin.substr(kScheme.size()) == from.host);
}

// Host name in "http://name:port" or "https://name".
std::string_view machine_of(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) return name_in(origin.substr(scheme.size()));
  }
  return {};
}

bool is_application_of_foxglove(std::string_view origin) {
  constexpr std::array<std::string_view, 3> kPages = {"https://app.foxglove.dev", "https://studio.foxglove.dev",
                                                      "file://"};
  constexpr std::array<std::string_view, 3> kOwnNames = {"localhost", "127.0.0.1", "[::1]"};
  return std::ranges::find(kPages, origin) != kPages.end() ||
         std::ranges::find(kOwnNames, machine_of(origin)) != kOwnNames.end();
}

bool may_ask(const WebAccess& access, const WebOrigin& from) {
  if (is_own_page(from)) return true;
  return from.is_foxglove && (!access.token.empty() || is_application_of_foxglove(from.origin));
}

bool equal_in_constant_time(std::string_view given, std::string_view secret) {
  unsigned difference = given.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const char character = i < given.size() ? given[i] : '\0';
    difference |= static_cast<unsigned char>(character ^ secret[i]);
  }
  return difference == 0;
}

}  // namespace

bool is_loopback(const std::string& address) {
  return address.starts_with("127.") || address == "::1" || address == "localhost";
}

WebAccess access_to(const std::string& bound_address) {
  if (!is_loopback(bound_address)) return {{}, make_token()};
  return {{"localhost", "127.0.0.1", "[::1]", bound_address}, ""};
}

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the system provides no random numbers for a token");
  }
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

std::string_view rejection_reason(const WebAccess& access, const WebOrigin& from) {
  if (!access.host_names.empty() && std::ranges::find(access.host_names, name_in(from.host)) == access.host_names.end())
    return "requests are answered only from this machine, under the name localhost";
  if (!may_ask(access, from)) return "requests are answered only from byre's own page";
  if (!access.token.empty() && !equal_in_constant_time(query_value(from.target, "token"), access.token))
    return "the token is missing or wrong: open the address printed at the start of byre";
  return {};
}

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

std::string_view query_value(std::string_view target, std::string_view name) {
  const std::size_t question = target.find('?');
  if (question == std::string_view::npos) return {};
  std::string_view rest = target.substr(question + 1);
  while (!rest.empty()) {
    const std::string_view field = rest.substr(0, rest.find('&'));
    if (field.starts_with(name) && field.substr(name.size()).starts_with('=')) return field.substr(name.size() + 1);
    rest.remove_prefix(std::min(rest.size(), field.size() + 1));
  }
  return {};
}

std::vector<std::string> reachable_addresses(const std::string& bound_address) {
  const bool is_v6 = bound_address == "::";
  if (!is_v6 && bound_address != "0.0.0.0") return {bound_address};
  std::vector<std::string> addresses = addresses_of_interfaces(is_v6);
  addresses.push_back("127.0.0.1");
  return addresses;
}

ConnectionTable::Admission ConnectionTable::open(const std::string& address) {
  const Id id = next_++;
  pending_.emplace(id, address);
  if (pending() <= limits_.pending) return {id, std::nullopt};
  return {id, oldest_of_busiest_address()};
}

ConnectionTable::Id ConnectionTable::oldest_of_busiest_address() const {
  std::map<std::string, int> counts;
  for (const auto& [id, address] : pending_) ++counts[address];
  const auto count_of = [&counts](const auto& stranger) { return counts.at(stranger.second); };
  return std::ranges::max_element(pending_, {}, count_of)->first;  // first of equals
}

bool ConnectionTable::accept(Id id) {
  if (accepted_ >= limits_.accepted || pending_.erase(id) == 0) return false;
  ++accepted_;
  return true;
}

void ConnectionTable::close(Id id) {
  if (pending_.erase(id) == 0) --accepted_;
}

double AcceptLimiter::left_at(Time now) const {
  return std::min(most_, left_ + per_second_ * std::chrono::duration<double>(now - last_).count());
}

void AcceptLimiter::count(Time now) {
  left_ = left_at(now) - 1.0;
  last_ = now;
}

std::chrono::milliseconds AcceptLimiter::wait(Time now) const {
  const double missing = std::max(0.0, 1.0 - left_at(now));
  return std::chrono::milliseconds(static_cast<long>(std::ceil(1e3 * missing / per_second_)));
}

int end_of_descriptors(const WebLimits& limits) {
  rlimit descriptors{};
  if (getrlimit(RLIMIT_NOFILE, &descriptors) != 0 || descriptors.rlim_cur > std::numeric_limits<int>::max()) {
    return std::numeric_limits<int>::max();
  }
  const int all = static_cast<int>(descriptors.rlim_cur);
  return all - std::min(limits.reserved_descriptors, all / 2);
}

}  // namespace byre
