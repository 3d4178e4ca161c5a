#include "byre/viewer/web_listener.h"

#include <optional>
#include <utility>

namespace byre {
namespace {

namespace websocket = boost::beast::websocket;
using boost::system::error_code;

constexpr std::size_t kMaxPageMessageBytes = 1 << 10;  // message from a page, which has nothing to say there

}  // namespace

void WebListener::start(const WebUpgrade& request) {
  stream_.set_option(websocket::stream_base::timeout::suggested(boost::beast::role_type::server));
  stream_.read_message_max(kMaxPageMessageBytes);
  stream_.async_accept(request, [self = shared_from_this()](error_code error) {
    if (error) return;
    self->is_open_ = true;
    self->read();
    self->tell();
  });
}

void WebListener::tell() {
  if (!is_open_ || is_sending_) return;
  std::optional<WebMessage> message = site_.next_message(progress_);
  if (!message) return;
  is_sending_ = true;
  message_ = std::move(*message);
  stream_.binary(message_.is_binary);
  stream_.async_write(boost::asio::buffer(message_.bytes), [self = shared_from_this()](error_code error, std::size_t) {
    self->is_sending_ = false;
    if (error) {
      self->is_open_ = false;
    } else {
      self->tell();
    }
  });
}

// What it is sent is dropped; reading is how a closed connection is noticed.
void WebListener::read() {
  stream_.async_read(received_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) {
      self->is_open_ = false;
      return;
    }
    self->received_.clear();
    self->read();
  });
}

}  // namespace byre
