#include "byre/viewer/web_guests.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <sys/resource.h>

namespace byre {

WebGuests::Arrival WebGuests::arrive(const std::string& address) {
  const Id id = next_++;
  strangers_.emplace(id, address);
  if (strangers() <= limits_.strangers) return {id, std::nullopt};
  return {id, oldest_of_the_most()};
}

WebGuests::Id WebGuests::oldest_of_the_most() const {
  std::map<std::string, int> counts;
  for (const auto& [id, address] : strangers_) ++counts[address];
  const auto count_of = [&counts](const auto& stranger) { return counts.at(stranger.second); };
  return std::ranges::max_element(strangers_, {}, count_of)->first;  // first of equals
}

bool WebGuests::introduce(Id id) {
  if (known_ >= limits_.known || strangers_.erase(id) == 0) return false;
  ++known_;
  return true;
}

void WebGuests::leave(Id id) {
  if (strangers_.erase(id) == 0) --known_;
}

double ArrivalRate::left_at(Time now) const {
  return std::min(most_, left_ + per_second_ * std::chrono::duration<double>(now - last_).count());
}

void ArrivalRate::count(Time now) {
  left_ = left_at(now) - 1.0;
  last_ = now;
}

std::chrono::milliseconds ArrivalRate::wait(Time now) const {
  const double missing = std::max(0.0, 1.0 - left_at(now));
  return std::chrono::milliseconds(static_cast<long>(std::ceil(1e3 * missing / per_second_)));
}

int end_of_descriptors(const WebLimits& limits) {
  rlimit descriptors{};
  if (getrlimit(RLIMIT_NOFILE, &descriptors) != 0 || descriptors.rlim_cur > std::numeric_limits<int>::max()) {
    return std::numeric_limits<int>::max();
  }
  const int all = static_cast<int>(descriptors.rlim_cur);
  return all - std::min(limits.free_descriptors, all / 2);
}

}  // namespace byre
