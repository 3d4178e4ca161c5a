#pragma once

#include "byre/viewer/web/connection_slot.h"
#include "byre/viewer/web/web_site.h"
#include "byre/viewer/web/web_socket.h"

#include <memory>
#include <utility>

namespace byre {

// WebSocket connection to a page, sending the messages of a site. Alive while an operation is pending. Used by the
// server's thread only.
class WebListener : public std::enable_shared_from_this<WebListener> {
 public:
  WebListener(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<ConnectionSlot> slot, WebSite& site)
      : slot_(std::move(slot)), socket_(std::move(socket)), site_(site) {}

  void start(const WebUpgrade& request);

  // Starts sending new messages unless busy.
  void notify();

 private:
  void read();

  std::unique_ptr<ConnectionSlot> slot_;
  WebSocket socket_;
  WebSite& site_;
  ListenerProgress progress_;
  WebMessage message_;  // message being sent
  bool is_open_ = false;
  bool is_sending_ = false;
};

}  // namespace byre
