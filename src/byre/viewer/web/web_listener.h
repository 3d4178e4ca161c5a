#pragma once

#include "byre/viewer/web/connection_table.h"
#include "byre/viewer/web/web_site.h"
#include "byre/viewer/web/web_socket.h"

#include <memory>
#include <string_view>
#include <utility>

namespace byre {

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

}  // namespace byre
