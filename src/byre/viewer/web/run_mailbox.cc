#include "byre/viewer/web/run_mailbox.h"

#include <utility>

namespace byre {

// Replaced values are freed outside the lock.

void RunMailbox::put(ShownFrame frame, FrameScene scene) {
  std::optional<FrameScene> incoming = std::move(scene);
  const std::lock_guard lock(mutex_);
  content_.frames.push_back(std::move(frame));
  content_.newest.swap(incoming);
}

void RunMailbox::put(MapScene online) {
  std::optional<MapScene> incoming = std::move(online);
  const std::lock_guard lock(mutex_);
  content_.online.swap(incoming);
}

void RunMailbox::put_end() {
  const std::lock_guard lock(mutex_);
  content_.has_ended = true;
}

RunMailbox::Content RunMailbox::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(content_, {});
}

}  // namespace byre
