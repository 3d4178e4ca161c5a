#pragma once

#include "byre/viewer/foxglove_client.h"
#include "byre/viewer/web_seat.h"
#include "byre/viewer/web_socket.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// A WebSocket that speaks Foxglove's protocol. Lives as long as an operation on it is under way. Owned by the server's
// thread, as all that it uses is.
class FoxgloveListener : public std::enable_shared_from_this<FoxgloveListener> {
 public:
  // session: see server_info_text
  FoxgloveListener(boost::asio::ip::tcp::socket&& socket, std::unique_ptr<WebSeat> seat, LiveTopics& topics,
                   const std::string& session)
      : seat_(std::move(seat)), socket_(std::move(socket)), client_(topics, session) {}

  // protocol: sub-protocol that is spoken
  void start(const WebUpgrade& request, std::string_view protocol);

  // Takes over what it has subscribed, and sends what is new, unless that is being done.
  void tell(const std::vector<LiveMessage>& messages);

 private:
  void read();
  void send();

  std::unique_ptr<WebSeat> seat_;
  WebSocket socket_;
  FoxgloveClient client_;
  FoxgloveOutput output_;  // what is being sent
  bool is_open_ = false;
  bool is_sending_ = false;
};

}  // namespace byre
