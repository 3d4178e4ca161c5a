#include "byre/viewer/web/web_listener.h"

#include <optional>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kMaxPageMessageBytes = 1 << 10;  // largest message from a page, which sends none

}  // namespace

void WebListener::start(const WebUpgrade& request) {
  socket_.accept(request, {.protocol = {}, .max_bytes = kMaxPageMessageBytes},
                 [self = shared_from_this()](bool is_open) {
                   if (!is_open) return;
                   self->is_open_ = true;
                   self->read();
                   self->notify();
                 });
}

void WebListener::notify() {
  if (!is_open_ || is_sending_) return;
  std::optional<WebMessage> message = site_.next_message(progress_);
  if (!message) return;
  is_sending_ = true;
  message_ = std::move(*message);
  socket_.write({message_.bytes, message_.is_binary}, {}, [self = shared_from_this()](bool is_open) {
    self->is_sending_ = false;
    if (is_open) {
      self->notify();
    } else {
      self->is_open_ = false;
    }
  });
}

// Received messages are dropped; reading detects a closed connection.
void WebListener::read() {
  socket_.read([self = shared_from_this()](const WebSocketMessage* message) {
    if (message) {
      self->read();
    } else {
      self->is_open_ = false;
    }
  });
}

}  // namespace byre
