#include "byre/viewer/web/web_socket.h"

#include <array>
#include <string>
#include <utility>

namespace byre {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;

// Largest message from a client: a list of subscriptions.
constexpr std::size_t kMaxClientMessageBytes = 64 << 10;

void WebSocket::accept(const WebUpgrade& request, std::string_view protocol, Done done) {
  stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
  stream_.set_option(
      websocket::stream_base::decorator([protocol = std::string(protocol)](websocket::response_type& response) {
        if (!protocol.empty()) response.set(beast::http::field::sec_websocket_protocol, protocol);
      }));
  stream_.read_message_max(kMaxClientMessageBytes);
  stream_.async_accept(request, [done = std::move(done)](error_code error) { done(!error); });
}

void WebSocket::write(const WebSocketMessage& head, std::span<const std::byte> rest, Done done) {
  stream_.binary(head.is_binary);
  const std::array<asio::const_buffer, 2> buffers = {asio::buffer(head.bytes), asio::buffer(rest.data(), rest.size())};
  stream_.async_write(buffers, [done = std::move(done)](error_code error, std::size_t) { done(!error); });
}

void WebSocket::read(Received received) {
  received_.clear();
  stream_.async_read(received_, [this, received = std::move(received)](error_code error, std::size_t) {
    if (error) {
      received(nullptr);
      return;
    }
    const auto bytes = received_.cdata();
    const WebSocketMessage message{{static_cast<const char*>(bytes.data()), bytes.size()}, stream_.got_binary()};
    received(&message);
  });
}

void WebSocket::close() {
  beast::get_lowest_layer(stream_).close();
}

}  // namespace byre
