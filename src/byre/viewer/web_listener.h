#pragma once

#include "byre/viewer/web_seat.h"
#include "byre/viewer/web_site.h"
#include "byre/viewer/web_socket.h"

#include <memory>
#include <utility>

namespace byre {

// A WebSocket to a page, which is told what a site has to tell. Lives as long as an operation on it is under way. Owned
// by the server's thread, as all that it uses is.
class WebListener : public std::enable_shared_from_this<WebListener> {
 public:
  WebListener(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<WebSeat> seat, WebSite& site)
      : seat_(std::move(seat)), socket_(std::move(socket)), site_(site) {}

  void start(const WebUpgrade& request);

  // Sends what is new, unless that is being done.
  void tell();

 private:
  void read();

  std::unique_ptr<WebSeat> seat_;
  WebSocket socket_;
  WebSite& site_;
  ListenerProgress progress_;
  WebMessage message_;  // message that is being sent
  bool is_open_ = false;
  bool is_sending_ = false;
};

}  // namespace byre
