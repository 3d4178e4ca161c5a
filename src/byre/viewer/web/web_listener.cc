#include "byre/viewer/web/web_listener.h"

#include <optional>
#include <span>

namespace byre {

void WebListener::start(const WebUpgrade& request, std::string_view protocol) {
  socket_.accept(request, protocol, [self = shared_from_this()](bool is_open) {
    if (!is_open) return;
    self->is_open_ = true;
    self->read();
    self->send();
  });
}

void WebListener::notify(const std::vector<LiveMessage>& messages) {
  if (!is_open_) return;
  for (const LiveMessage& message : messages) feed_->offer(message);
  send();
}

void WebListener::send() {
  if (!is_open_ || is_sending_) return;
  std::optional<WebMessage> message = feed_->next();
  if (!message) return;
  is_sending_ = true;
  message_ = std::move(*message);
  const auto rest = message_.rest ? std::span(*message_.rest) : std::span<const std::byte>();
  socket_.write({message_.bytes, message_.is_binary}, rest, [self = shared_from_this()](bool is_open) {
    self->is_sending_ = false;
    self->is_open_ = self->is_open_ && is_open;
    self->send();
  });
}

// Reading also detects a closed connection.
void WebListener::read() {
  socket_.read([self = shared_from_this()](const WebSocketMessage* message) {
    if (message != nullptr && self->feed_->receive(message->bytes, message->is_binary)) {
      self->send();
      return self->read();
    }
    self->is_open_ = false;
    if (message != nullptr) self->socket_.close();
  });
}

}  // namespace byre
