#include "byre/viewer/foxglove_listener.h"

#include <array>
#include <optional>
#include <utility>

namespace byre {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

constexpr std::size_t kMaxClientMessageBytes = 64 << 10;  // message from a client, which lists subscriptions

}  // namespace

void FoxgloveListener::start(const WebUpgrade& request, std::string_view protocol) {
  stream_.set_option(websocket::stream_base::timeout::suggested(boost::beast::role_type::server));
  stream_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
    response.set(boost::beast::http::field::sec_websocket_protocol, {protocol.data(), protocol.size()});
  }));
  stream_.read_message_max(kMaxClientMessageBytes);
  stream_.async_accept(request, [self = shared_from_this()](error_code error) {
    if (error) return;
    self->is_open_ = true;
    self->read();
    self->send();
  });
}

void FoxgloveListener::tell(const std::vector<LiveMessage>& messages) {
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
  const asio::const_buffer rest = output_.rest ? asio::buffer(*output_.rest) : asio::const_buffer();
  stream_.binary(output_.is_binary);
  stream_.async_write(std::array<asio::const_buffer, 2>{asio::buffer(output_.head), rest},
                      [self = shared_from_this()](error_code error, std::size_t) {
                        self->is_sending_ = false;
                        if (error) {
                          self->is_open_ = false;
                        } else {
                          self->send();
                        }
                      });
}

void FoxgloveListener::read() {
  stream_.async_read(received_, [self = shared_from_this()](error_code error, std::size_t) {
    if (error) {
      self->is_open_ = false;
      return;
    }
    const auto bytes = self->received_.cdata();
    const bool is_welcome =
        self->client_.receive({static_cast<const char*>(bytes.data()), bytes.size()}, self->stream_.got_binary());
    self->received_.clear();
    if (is_welcome) {
      self->send();
      self->read();
    } else {
      self->close();
    }
  });
}

// It may read nothing, so it is not waited for.
void FoxgloveListener::close() {
  is_open_ = false;
  boost::beast::get_lowest_layer(stream_).close();
}

}  // namespace byre
