#pragma once

#include "byre/viewer/web/web_access.h"
#include "byre/viewer/web/web_listener.h"
#include "byre/viewer/web/web_site.h"
#include "byre/viewer/web/web_socket.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace byre {

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
