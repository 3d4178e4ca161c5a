#pragma once

#include "byre/viewer/web/connection_slot.h"
#include "byre/viewer/web/foxglove_client.h"
#include "byre/viewer/web/web_socket.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// WebSocket connection with Foxglove's protocol. Alive while an operation is pending. Used by the server's thread only.
class FoxgloveListener : public std::enable_shared_from_this<FoxgloveListener> {
 public:
  // session: see server_info_text
  FoxgloveListener(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<ConnectionSlot> slot, LiveTopics& topics,
                   const std::string& session)
      : slot_(std::move(slot)), socket_(std::move(socket)), client_(topics, session) {}

  // protocol: chosen sub-protocol
  void start(const WebUpgrade& request, std::string_view protocol);

  // Queues messages of subscribed topics, and starts sending unless busy.
  void notify(const std::vector<LiveMessage>& messages);

 private:
  void read();
  void send();

  std::unique_ptr<ConnectionSlot> slot_;
  WebSocket socket_;
  FoxgloveClient client_;
  FoxgloveOutput output_;  // message being sent
  bool is_open_ = false;
  bool is_sending_ = false;
};

}  // namespace byre
