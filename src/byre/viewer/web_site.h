#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace byre {

struct WebRequest {
  enum class Method : std::uint8_t { get, post };

  Method method = Method::get;
  std::string path;  // path without the query
  std::string body;
};

struct WebResponse {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;  // text or bytes
};

WebResponse page_response();  // the viewer's page
WebResponse bytes_response(std::string bytes, const char* content_type = "application/octet-stream");
WebResponse problem_response(int status, std::string_view problem);  // JSON with the field "problem"
WebResponse not_found(const WebRequest& request);

// A message of a WebSocket.
struct WebMessage {
  std::string bytes;
  bool is_binary = false;
};

// How much of what a site has to tell a listener (a page that is open somewhere) has been told.
struct ListenerProgress {
  std::size_t frames = 0;     // reports of frames
  std::size_t images = 0;     // the newest image that was sent, counted from 1
  std::size_t maps = 0;       // the newest map that was announced, counted from 1
  bool end_is_known = false;  // whether the end of the run has been told
};

// What a web server serves. All functions are called from the server's thread, one at a time.
class WebSite {
 public:
  virtual ~WebSite() = default;

  // An exception becomes a response: InputError 400, others 500, both with what() as the "problem".
  virtual WebResponse answer(const WebRequest& request) = 0;

  // Takes in what other threads have handed over, after WebServer::wake().
  virtual void refresh() {}

  // What a listener should be sent next, and notes it in its progress; empty when it knows all there is. Asked again
  // only once the last message is sent, so that a slow listener is told less, and nothing queues up for it.
  virtual std::optional<WebMessage> next_message(ListenerProgress&) { return std::nullopt; }
};

}  // namespace byre
