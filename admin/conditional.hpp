#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "admin/http.hpp"

namespace wayfuse {

/// A strong validator of a representation: BLAKE2b-128 in quotes [RFC 9110].
std::string etag_of(std::string_view representation);

/// Gives an answer its ETag; 304 without a body where the request's If-None-Match names it.
Response with_etag(const Request& request, Response response);

/// 412 where If-Match names another version than the one there is now; a request without it goes on. Call it where nothing
/// can change in between: on the store's thread.
std::optional<Response> changed_since(const Request& request, std::string_view current_representation);

}  // namespace wayfuse
