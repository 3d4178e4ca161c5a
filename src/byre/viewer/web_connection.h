#pragma once

#include "byre/viewer/foxglove_listener.h"
#include "byre/viewer/web_access.h"
#include "byre/viewer/web_listener.h"
#include "byre/viewer/web_seat.h"
#include "byre/viewer/web_site.h"
#include "byre/viewer/web_socket.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace byre {

// What connections are served from. Owned by the server's thread.
struct WebService {
  std::unique_ptr<WebSite> site;
  std::shared_ptr<LiveTopics> topics;  // null: Foxglove's protocol is not spoken
  WebAccess access;
  std::string session;  // text that no other server has, for Foxglove's protocol
  std::vector<std::weak_ptr<WebListener>> listeners;
  std::vector<std::weak_ptr<FoxgloveListener>> foxglove_listeners;

  void tell_listeners();
};

// Requests of one HTTP connection, one after the other, until one of them makes a listener of it. Of a stranger nothing
// is read but the head of one request, in the time it has for that; if it is refused, the connection ends. Owned by the
// server's thread.
class WebConnection : public std::enable_shared_from_this<WebConnection> {
 public:
  // The service outlives this.
  WebConnection(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<WebSeat> seat, WebService& service)
      : seat_(std::move(seat)), stream_(std::move(socket)), service_(service) {}

  void welcome(std::chrono::milliseconds patience) { read_head(patience); }

  void close() { stream_.close(); }

 private:
  using Request = WebUpgrade;

  void read_head(std::chrono::milliseconds patience);
  std::string_view protocol_of(const Request& request) const;
  void judge();
  void answer_request();
  void respond(const WebResponse& response, bool may_go_on);
  void end();

  std::unique_ptr<WebSeat> seat_;
  boost::beast::tcp_stream stream_;
  WebService& service_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;  // parser of one request
  boost::beast::http::response<boost::beast::http::string_body> response_;  // response that is being sent
  bool is_known_ = false;                                                   // whether it has asked for what it may have
};

}  // namespace byre
