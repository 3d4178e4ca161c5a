#include "byre/playback/autosave.h"

#include <chrono>
#include <exception>
#include <utility>

namespace byre {

bool Autosave::is_saving() const {
  return saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

void Autosave::update(const MapGraph& online, const std::function<StoredMap()>& metadata) {
  if (since_last_.seconds() < interval_s_ || is_saving()) return;
  finish();
  since_last_ = {};
  saving_ = std::async(std::launch::async, [this, map = online, stored = metadata()]() mutable {
    stored.map = std::move(map);
    save_(std::move(stored));
  });
}

void Autosave::finish() {
  if (!saving_.valid()) return;
  try {
    saving_.get();
    ++saved_;
  } catch (const std::exception& error) {  // mapping continues; the next save may succeed
    failures_.emplace_back(error.what());
  }
}

}  // namespace byre
