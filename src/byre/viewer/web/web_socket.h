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

// WebSocket of an upgraded connection. At most one operation of each kind is pending; its callback keeps the owner
// alive. Used by the server's thread only.
class WebSocket {
 public:
  using Done = std::function<void(bool is_open)>;
  using Received = std::function<void(const WebSocketMessage* message)>;  // null: the connection has ended

  explicit WebSocket(boost::asio::ip::tcp::socket&& socket) : stream_(std::move(socket)) {}

  // protocol: chosen sub-protocol; empty: none
  void accept(const WebUpgrade& request, std::string_view protocol, Done done);

  // Sends head and rest as one message; both must live until done.
  void write(const WebSocketMessage& head, std::span<const std::byte> rest, Done done);

  void read(Received received);

  // Closes immediately, without the closing handshake, as the client may not be reading.
  void close();

 private:
  boost::beast::websocket::stream<boost::beast::tcp_stream, false> stream_;  // without compression
  boost::beast::flat_buffer received_;
};

}  // namespace byre
