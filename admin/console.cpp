#include "admin/api.hpp"
#include <console_files.inc>  // generated: one constant a file of admin/console

namespace wayfuse {
namespace {

// Nothing from elsewhere, nothing inline: the page works in a building without internet and cannot be made to call out.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

Handler page(const char* content_type, std::string_view content) {
  return [content_type, content](const Request&, const PathValues&, Respond respond) {
    Response response;
    response.content_type = content_type;
    response.headers["content-security-policy"] = kPolicy;
    response.headers["x-content-type-options"] = "nosniff";
    response.headers["referrer-policy"] = "no-referrer";
    response.headers["cache-control"] = "no-cache";
    response.body = content;
    respond(std::move(response));
  };
}

}  // namespace

void add_console_routes(Router& router) {
  router.add({"GET", "/", Scope::kPublic, "To the console", [](const Request&, const PathValues&, Respond respond) {
                Response response;
                response.status = 302;
                response.headers["location"] = "/console/";
                respond(std::move(response));
              }});
  router.add({"GET", "/console/", Scope::kPublic, "The operator's console", page("text/html; charset=utf-8", k_index_html)});
  router.add({"GET", "/console/console.css", Scope::kPublic, "Its style", page("text/css; charset=utf-8", k_console_css)});
  router.add({"GET", "/console/console.js", Scope::kPublic, "Its script", page("text/javascript; charset=utf-8", k_console_js)});
}

}  // namespace wayfuse
