#pragma once

#include "byre/viewer/web_seat.h"
#include "byre/viewer/web_site.h"

#include <memory>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace byre {

using WebUpgrade = boost::beast::http::request<boost::beast::http::string_body>;

// A WebSocket to a page, which is told what a site has to tell. Lives as long as an operation on it is under way. Owned
// by the server's thread, as all that it uses is.
class WebListener : public std::enable_shared_from_this<WebListener> {
 public:
  WebListener(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<WebSeat> seat, WebSite& site)
      : seat_(std::move(seat)), stream_(std::move(socket)), site_(site) {}

  void start(const WebUpgrade& request);

  // Sends what is new, unless that is being done.
  void tell();

 private:
  void read();

  std::unique_ptr<WebSeat> seat_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
  WebSite& site_;
  ListenerProgress progress_;
  WebMessage message_;  // message that is being sent
  boost::beast::flat_buffer received_;
  bool is_open_ = false;
  bool is_sending_ = false;
};

}  // namespace byre
