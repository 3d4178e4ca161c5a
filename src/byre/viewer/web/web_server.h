#pragma once

#include "byre/viewer/web/live_topics.h"
#include "byre/viewer/web/web_access.h"
#include "byre/viewer/web/web_site.h"

#include <memory>
#include <string>
#include <vector>

namespace byre {

struct WebServerOptions {
  std::string address = "127.0.0.1";  // IP address of this machine; 0.0.0.0 or :: for all interfaces
  int port = 8017;                    // 0: any free port
  WebLimits limits{};
};

// Serves a site over HTTP, and WebSocket at /live, on its own thread. Destruction closes all connections without
// waiting for clients. Access rules: web_access.h; limits: connection_table.h.
class WebServer {
 public:
  // topics: served with Foxglove's protocol at any path; null: not served. Throws InputError if the address is not of
  // this machine, or the port is in use or not permitted.
  WebServer(const WebServerOptions& options, std::unique_ptr<WebSite> site,
            std::shared_ptr<LiveTopics> topics = nullptr);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  // URLs for a browser, with the token if required. For all interfaces: network addresses first, loopback last.
  const std::vector<std::string>& urls() const;
  int port() const;

  // Schedules, on the server's thread, refresh() of the site, sending of topic messages, and news to listeners.
  // Thread-safe.
  void wake();

 private:
  class Core;
  std::unique_ptr<Core> core_;
};

}  // namespace byre
