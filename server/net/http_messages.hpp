#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "admin/router.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;
using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;
using HttpHead = boost::beast::http::response<boost::beast::http::empty_body>;

/// What the API is asked, in its own words: names of fields in lower case, repeated ones joined by commas, HEAD as GET. `peer` is the
/// sender's address. A target that cannot be read is a fault.
Result<Request> request_from(const HttpRequest& message, const std::string& peer);

/// An answer that is there as a whole; to HEAD without its body, but with the length it would have.
HttpResponse whole_answer(Response response, unsigned version, bool head_only);

/// Status and fields of an answer whose body follows in pieces.
HttpHead head_of(const Response& response, unsigned version);

}  // namespace wayfuse
