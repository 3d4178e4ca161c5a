#include "byre/viewer/web/foxglove_listener.h"

#include <optional>
#include <span>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kMaxClientMessageBytes = 64 << 10;  // largest client message: a list of subscriptions

}  // namespace

void FoxgloveListener::start(const WebUpgrade& request, std::string_view protocol) {
  socket_.accept(request, {.protocol = protocol, .max_bytes = kMaxClientMessageBytes},
                 [self = shared_from_this()](bool is_open) {
                   if (!is_open) return;
                   self->is_open_ = true;
                   self->read();
                   self->send();
                 });
}

void FoxgloveListener::notify(const std::vector<LiveMessage>& messages) {
  if (!is_open_) return;
  for (const LiveMessage& message : messages) client_.offer(message);
  send();
}

void FoxgloveListener::send() {
  if (!is_open_ || is_sending_) return;
  std::optional<FoxgloveOutput> output = client_.next();
  if (!output) return;
  is_sending_ = true;
  output_ = std::move(*output);
  const auto rest = output_.rest ? std::span(*output_.rest) : std::span<const std::byte>();
  socket_.write({output_.head, output_.is_binary}, rest, [self = shared_from_this()](bool is_open) {
    self->is_sending_ = false;
    if (is_open) {
      self->send();
    } else {
      self->is_open_ = false;
    }
  });
}

void FoxgloveListener::read() {
  socket_.read([self = shared_from_this()](const WebSocketMessage* message) {
    if (!message) {
      self->is_open_ = false;
    } else if (self->client_.receive(message->bytes, message->is_binary)) {
      self->send();
      self->read();
    } else {
      self->is_open_ = false;
      self->socket_.close();
    }
  });
}

}  // namespace byre
