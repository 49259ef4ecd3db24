#include <sodium.h>

#include "admin/api.hpp"
#include "admin/embedded_file.hpp"

WAYFUSE_EMBED(wayfuse_console_html, WAYFUSE_CONSOLE_DIST "/index.html");
WAYFUSE_EMBED(wayfuse_console_css, WAYFUSE_CONSOLE_DIST "/console.css");
WAYFUSE_EMBED(wayfuse_console_js, WAYFUSE_CONSOLE_DIST "/console.js");
WAYFUSE_EMBED(wayfuse_console_font, WAYFUSE_CONSOLE_DIST "/inter.woff2");
WAYFUSE_EMBED(wayfuse_console_licences, WAYFUSE_CONSOLE_DIST "/licences.txt");

namespace wayfuse {
namespace {

// Nothing from elsewhere, nothing inline: the page works in a building without internet and cannot be made to call out. Pictures of
// floor plans are shown from memory (blob:).
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; connect-src 'self'; img-src 'self' data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// Names the content: 128 bits of its BLAKE2b, so that a browser keeps a file until a newer server brings another.
std::string tag_of(std::string_view content) {
  unsigned char hash[16];
  crypto_generichash(hash, sizeof hash, reinterpret_cast<const unsigned char*>(content.data()), content.size(), nullptr, 0);
  char hex[2 * sizeof hash + 1];
  sodium_bin2hex(hex, sizeof hex, hash, sizeof hash);
  return '"' + std::string(hex) + '"';
}

Handler file(const char* content_type, std::string_view content) {
  return [content_type, content, tag = tag_of(content)](const Request& request, const PathValues&, Respond respond) {
    Response response;
    response.content_type = content_type;
    response.headers["etag"] = tag;
    response.headers["cache-control"] = "no-cache";  // kept, but asked about each time
    response.headers["content-security-policy"] = kPolicy;
    response.headers["x-content-type-options"] = "nosniff";
    response.headers["referrer-policy"] = "no-referrer";
    response.headers["cross-origin-opener-policy"] = "same-origin";
    const auto known = request.headers.find("if-none-match");
    const bool unchanged = known != request.headers.end() && known->second.find(tag) != std::string::npos;
    if (unchanged) response.status = 304;
    else response.body = content;
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
  const auto add = [&router](const char* name, const char* summary, const char* content_type, std::string_view content) {
    router.add({"GET", std::string("/console/") + name, Scope::kPublic, summary, file(content_type, content)});
  };
  add("", "The operator's console", "text/html; charset=utf-8", {wayfuse_console_html, wayfuse_console_html_end});
  add("console.css", "Its style", "text/css; charset=utf-8", {wayfuse_console_css, wayfuse_console_css_end});
  add("console.js", "Its script", "text/javascript; charset=utf-8", {wayfuse_console_js, wayfuse_console_js_end});
  add("inter.woff2", "Its typeface", "font/woff2", {wayfuse_console_font, wayfuse_console_font_end});
  add("licences.txt", "The licences of what it is made of", "text/plain; charset=utf-8",
      {wayfuse_console_licences, wayfuse_console_licences_end});
}

}  // namespace wayfuse
