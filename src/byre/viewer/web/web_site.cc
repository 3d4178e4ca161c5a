#include "byre/viewer/web/web_site.h"

#include "byre/viewer/web/web_messages.h"

#include <utility>

namespace byre {

WebResponse bytes_response(std::string bytes, const char* content_type) {
  return {200, content_type, std::move(bytes)};
}

WebResponse problem_response(int status, std::string_view problem) {
  return {status, "application/json", dump_json({{"problem", problem}})};
}

WebResponse not_found(const WebRequest& request) {
  return problem_response(404, "not found: " + request.path);
}

}  // namespace byre
