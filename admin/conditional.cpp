#include "admin/conditional.hpp"

#include <sodium.h>

#include <array>

namespace wayfuse {
namespace {

// Whether a list like `"a", W/"b"` holds this validator; `*` holds all.
bool names(std::string_view list, std::string_view etag) {
  if (list == "*") return true;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view entry = list.substr(0, comma);
    list.remove_prefix(std::min(comma + 1, list.size()));
    while (!entry.empty() && (entry.front() == ' ' || entry.front() == '\t')) entry.remove_prefix(1);
    while (!entry.empty() && (entry.back() == ' ' || entry.back() == '\t')) entry.remove_suffix(1);
    if (entry == etag) return true;
  }
  return false;
}

}  // namespace

std::string etag_of(std::string_view representation) {
  std::array<unsigned char, 16> hash;
  crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(representation.data()), representation.size(),
                     nullptr, 0);
  std::string text(2 * hash.size() + 1, '\0');
  sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
  text.pop_back();  // its final zero
  return '"' + text + '"';
}

Response with_etag(const Request& request, Response response) {
  if (response.status >= 300) return response;
  response.headers["etag"] = etag_of(response.body);
  const auto known = request.headers.find("if-none-match");
  if (request.method == "GET" && known != request.headers.end() && names(known->second, response.headers["etag"])) {
    response.status = 304;
    response.body.clear();
  }
  return response;
}

std::optional<Response> changed_since(const Request& request, std::string_view current_representation) {
  const auto wanted = request.headers.find("if-match");
  if (wanted == request.headers.end() || names(wanted->second, etag_of(current_representation))) return std::nullopt;
  return problem({FaultCode::kConflict, "If-Match", "it has changed since: read it again"}, 412);
}

}  // namespace wayfuse
