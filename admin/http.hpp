#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/fault.hpp"

namespace wayfuse {

/// A plain HTTP request: no Beast above server/net.
struct Request {
  std::string method;                                ///< upper case
  std::string path;                                  ///< decoded, without the query
  std::map<std::string, std::string> query;
  std::map<std::string, std::string> headers;        ///< lower-case names
  std::string body;
  std::string peer;                                  ///< address, for rate limits; never logged
};

struct Response {
  int status = 200;
  std::map<std::string, std::string> headers;
  std::string content_type = "application/json";
  std::string body;
};

/// An RFC 9457 problem document; the status is the fault table's unless one is given.
Response problem(const Fault& fault, int status = 0);

/// Called exactly once, on any thread; server/net brings it back to the connection's strand.
using Respond = std::function<void(Response)>;

}  // namespace wayfuse
