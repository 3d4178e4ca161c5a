#include "byre/viewer/web/status_site.h"

#include "byre/base/markup.h"

#include <sstream>

namespace byre {
namespace {

// For people who open the address in a browser. Loads itself again every two seconds.
std::string front_page(const ProgramStatus& status) {
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"2\">"
      "<title>byre node</title></head>\n<body><h1>byre node</h1>\n<p>" +
      markup_escaped(status.summary.empty() ? "starting" : status.summary) +
      "</p>\n<ul>\n<li><code>/healthz</code>: this line; status 200 or 503</li>\n"
      "<li><code>/metrics</code>: the counters below, for Prometheus</li>\n"
      "<li>Map, path and images: Foxglove, \"Open connection\", ws:// and the address of this page</li>\n"
      "<li>A saved map: <code>byre view MAP.byre</code></li>\n</ul>\n<pre>\n";
  std::istringstream lines(status.metrics);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) page += markup_escaped(line) + "\n";
  }
  return page + "</pre></body></html>\n";
}

}  // namespace

WebResponse StatusSite::answer(const WebRequest& request) {
  const bool asks = request.method == WebRequest::Method::get;
  if (asks && request.path == "/healthz") {
    const ProgramStatus status = board_->get();
    return {status.is_healthy ? 200 : 503, "text/plain; charset=utf-8", status.summary + "\n"};
  }
  if (asks && request.path == "/metrics")
    return {200, "text/plain; version=0.0.4; charset=utf-8", board_->get().metrics};
  if (asks && request.path == "/") return {200, "text/html; charset=utf-8", front_page(board_->get())};
  return not_found(request);
}

}  // namespace byre
