#pragma once

#include "byre/viewer/web/web_access.h"
#include "byre/viewer/web/web_site.h"

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

// WebSocket connection that sends the messages of a feed. Alive while an operation is pending. Used by the server's
// thread only.
class WebListener : public std::enable_shared_from_this<WebListener> {
 public:
  WebListener(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<ConnectionSlot> slot,
              std::unique_ptr<WebFeed> feed)
      : slot_(std::move(slot)), socket_(std::move(socket)), feed_(std::move(feed)) {}

  // protocol: chosen sub-protocol; empty: none
  void start(const WebUpgrade& request, std::string_view protocol);

  // Offers topic messages to the feed, and starts sending unless busy.
  void notify(const std::vector<LiveMessage>& messages);

 private:
  void read();
  void send();

  std::unique_ptr<ConnectionSlot> slot_;
  WebSocket socket_;
  std::unique_ptr<WebFeed> feed_;
  WebMessage message_;  // message being sent
  bool is_open_ = false;
  bool is_sending_ = false;
};

// State shared by all connections. Owned by the server's thread.
struct WebService {
  std::unique_ptr<WebSite> site;
  std::shared_ptr<LiveTopics> topics;  // null: without Foxglove's protocol
  WebAccess access;
  std::string session;  // unique text per server, for Foxglove's protocol
  std::vector<std::weak_ptr<WebListener>> listeners;

  void notify_listeners();
};

// HTTP connection: serves requests in turn until one upgrades to a WebSocket. A connection without an accepted request
// may send a single request head within a time limit, and is closed if rejected. Used by the server's thread only.
class WebConnection : public std::enable_shared_from_this<WebConnection> {
 public:
  // The service outlives this.
  WebConnection(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<ConnectionSlot> slot, WebService& service)
      : slot_(std::move(slot)), stream_(std::move(socket)), service_(service) {}

  void start(std::chrono::milliseconds request_timeout) { read_head(request_timeout); }

  void close() { stream_.close(); }

 private:
  using Request = WebUpgrade;

  void read_head(std::chrono::milliseconds request_timeout);
  std::string_view protocol_of(const Request& request) const;
  void check_access();
  void answer_request();
  void respond(const WebResponse& response, bool may_keep_alive);
  void end();

  std::unique_ptr<ConnectionSlot> slot_;
  boost::beast::tcp_stream stream_;
  WebService& service_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;  // current request
  boost::beast::http::response<boost::beast::http::string_body> response_;                     // response being sent
  bool is_accepted_ = false;  // whether a request was accepted
};

}  // namespace byre
