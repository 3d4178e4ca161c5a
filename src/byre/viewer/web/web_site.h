#pragma once

#include "byre/viewer/web/live_topics.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

struct WebRequest {
  enum class Method : std::uint8_t { get, post };

  Method method = Method::get;
  std::string path;  // without the query
  std::string body;
};

struct WebResponse {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;  // text or bytes
};

WebResponse page_response();  // HTML of the page, built from web/ and embedded at compile time
WebResponse bytes_response(std::string bytes, const char* content_type = "application/octet-stream");
WebResponse problem_response(int status, std::string_view problem);  // JSON with the field "problem"
WebResponse not_found(const WebRequest& request);

// WebSocket message: bytes, then rest.
struct WebMessage {
  std::string bytes;
  bool is_binary = false;
  std::shared_ptr<const std::vector<std::byte>> rest{};  // null: none
};

// Messages for a listener, and its requests.
class WebFeed {
 public:
  virtual ~WebFeed() = default;
  virtual std::optional<WebMessage> next() = 0;  // message to send; empty: up to date
  // Handles a message of the listener. False: disconnect it.
  virtual bool receive(std::string_view /*bytes*/, bool /*is_binary*/) { return true; }
  virtual void offer(const LiveMessage& /*message*/) {}  // message of a topic
};

// Progress of the messages sent to a listener (an open page).
struct ListenerProgress {
  std::size_t frames = 0;  // reports sent
  std::size_t images = 0;  // number of the newest image sent, from 1
  std::size_t maps = 0;    // number of the newest map announced, from 1
  bool end_sent = false;   // whether the end of the run was sent
};

// Content of a web server. All functions are called from the server's thread.
class WebSite {
 public:
  virtual ~WebSite() = default;

  // Exceptions become responses with what() as the "problem": InputError 400, others 500.
  virtual WebResponse answer(const WebRequest& request) = 0;

  // Takes over data of other threads, after WebServer::wake().
  virtual void refresh() {}

  // Next message for a listener; updates its progress. Empty if the listener is up to date. Called after the previous
  // message was sent, so a slow listener skips messages instead of queueing them.
  virtual std::optional<WebMessage> next_message(ListenerProgress&) { return std::nullopt; }
};

}  // namespace byre
