#include "byre/viewer/web/status_site.h"

namespace byre {

WebResponse StatusSite::answer(const WebRequest& request) {
  const bool asks = request.method == WebRequest::Method::get;
  if (asks && request.path == "/healthz") {
    const ProgramStatus status = board_->get();
    return {status.is_healthy ? 200 : 503, "text/plain; charset=utf-8", status.summary + "\n"};
  }
  if (asks && request.path == "/metrics")
    return {200, "text/plain; version=0.0.4; charset=utf-8", board_->get().metrics};
  return not_found(request);
}

}  // namespace byre
