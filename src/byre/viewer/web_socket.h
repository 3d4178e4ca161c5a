#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace byre {

using WebUpgrade = boost::beast::http::request<boost::beast::http::string_body>;

struct WebSocketMessage {
  std::string_view bytes;
  bool is_binary = false;
};

// A connection that became a WebSocket. Each kind of operation is under way once at a time; what is called when it is
// done keeps the owner alive until then. Owned by the server's thread.
class WebSocket {
 public:
  using Done = std::function<void(bool is_open)>;
  using Received = std::function<void(const WebSocketMessage* message)>;  // null: the connection has ended

  explicit WebSocket(boost::asio::ip::tcp::socket&& socket) : stream_(std::move(socket)) {}

  struct Terms {
    std::string_view protocol;   // sub-protocol that is spoken; empty: none
    std::size_t most_bytes = 0;  // bytes of a message from the other side
  };
  void accept(const WebUpgrade& request, const Terms& terms, Done done);

  // Sends head and rest as one message; both must live until it is done.
  void write(const WebSocketMessage& head, std::span<const std::byte> rest, Done done);

  void read(Received received);

  // At once, without waiting for the other side, which may read nothing.
  void close();

 private:
  boost::beast::websocket::stream<boost::beast::tcp_stream, false> stream_;  // never deflates
  boost::beast::flat_buffer received_;
};

}  // namespace byre
