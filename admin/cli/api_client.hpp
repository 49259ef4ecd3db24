#pragma once

#include <string>

#include "wayfuse/proto/result.hpp"

namespace wayfuse::cli {

struct Connection {
  std::string server;      ///< base URL, like http://127.0.0.1:8420
  std::string key;
  std::string authority;   ///< PEM file to trust besides the system's; empty = none
};

struct Reply {
  int status = 0;
  std::string body;
};

/// One HTTP exchange with the admin API. A fault = the server could not be reached; a problem document is a Reply.
Result<Reply> exchange(const Connection& connection, const std::string& method, const std::string& path,
                       const std::string& body = {});

}  // namespace wayfuse::cli
