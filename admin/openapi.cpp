#include "admin/api.hpp"
#include "admin/description_page.hpp"
#include "admin/embedded_file.hpp"

WAYFUSE_EMBED(wayfuse_openapi, WAYFUSE_OPENAPI "/openapi.json");
WAYFUSE_EMBED(wayfuse_asyncapi, WAYFUSE_ASYNCAPI "/asyncapi.json");
WAYFUSE_EMBED(wayfuse_docs_css, WAYFUSE_OPENAPI "/docs.css");

namespace wayfuse {
namespace {

Handler fixed(const char* content_type, std::string body) {
  return [content_type, body = std::move(body)](const Request&, const PathValues&, Respond respond) {
    Response response = json_response(200, body);
    response.content_type = content_type;
    response.headers["content-security-policy"] = "default-src 'none'; style-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    response.headers["x-content-type-options"] = "nosniff";
    respond(std::move(response));
  };
}

}  // namespace

void add_openapi_routes(Router& router) {
  const std::string openapi(wayfuse_openapi, wayfuse_openapi_end);
  const std::string asyncapi(wayfuse_asyncapi, wayfuse_asyncapi_end);
  const auto page = [](std::string html) { return fixed("text/html; charset=utf-8", std::move(html)); };
  router.add({"GET", "/v1/openapi.json", Scope::kPublic, "This document", fixed("application/json", openapi)});
  router.add({"GET", "/v1/asyncapi.json", Scope::kPublic, "The WebSocket side, as AsyncAPI 3", fixed("application/json", asyncapi)});
  router.add({"GET", "/docs", Scope::kPublic, "This document, to read", page(openapi_page(openapi))});
  router.add({"GET", "/docs/sessions", Scope::kPublic, "The WebSocket side, to read", page(asyncapi_page(asyncapi))});
  router.add({"GET", "/docs/docs.css", Scope::kPublic, "Its style",
              fixed("text/css; charset=utf-8", std::string(wayfuse_docs_css, wayfuse_docs_css_end))});
}

}  // namespace wayfuse
