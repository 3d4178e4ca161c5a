#include "byre/viewer/web/connection_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <sys/resource.h>

namespace byre {

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
