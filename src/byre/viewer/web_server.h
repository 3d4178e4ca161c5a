#pragma once

#include "byre/viewer/live_topics.h"
#include "byre/viewer/web_guests.h"
#include "byre/viewer/web_site.h"

#include <memory>
#include <string>
#include <vector>

namespace byre {

struct WebServerOptions {
  std::string address = "127.0.0.1";  // an IP address of this machine; 0.0.0.0 or :: for all of them
  int port = 8017;                    // 0: one that is free
  WebLimits limits{};
};

// Serves a site over HTTP and, at the path /live, WebSocket, from a thread of its own, until it is destroyed: that
// closes all connections and waits for nobody. What may be asked by whom is said in web_access.h, and how much
// connections may take of the program in web_guests.h.
class WebServer {
 public:
  // Throws InputError when the address is none of this machine's or the port is in use or not allowed.
  // topics: told to whoever speaks Foxglove's protocol, at any path; without them nobody is.
  WebServer(const WebServerOptions& options, std::unique_ptr<WebSite> site,
            std::shared_ptr<LiveTopics> topics = nullptr);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  // To open in a browser; holds the token where one is needed. At all addresses of the machine there are several, those
  // that other machines can open first, and last the one for this machine.
  const std::vector<std::string>& urls() const;
  int port() const;

  // Has the site refreshed, messages of the topics taken and listeners told what is new, soon and in the server's
  // thread. May be called from any.
  void wake();

 private:
  class Core;
  std::unique_ptr<Core> core_;
};

}  // namespace byre
