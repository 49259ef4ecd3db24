#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

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
  std::map<std::string, std::string> headers = {};  ///< lower-case names
};

/// One HTTP exchange with the admin API. A fault = the server could not be reached; a problem document is a Reply.
Result<Reply> exchange(const Connection& connection, const std::string& method, const std::string& path,
                       const std::string& body = {}, const std::string& content_type = "application/json",
                       const std::map<std::string, std::string>& headers = {});

/// Reads an answer that does not end, piece by piece, until `take` answers false or the server closes. Reply::body holds
/// what came with a status of 400 and more.
Result<Reply> follow(const Connection& connection, const std::string& path, const std::map<std::string, std::string>& headers,
                     const std::function<bool(std::string_view)>& take);

}  // namespace wayfuse::cli
