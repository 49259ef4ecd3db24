#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
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
  // Who asks, once the router knows:
  std::uint64_t key_id = 0;
  bool coarse = false;                               ///< the key sees zones, never coordinates [C19]
};

/// A body that comes in pieces: a file too large to hold, or events as they happen.
///
/// Thread: next() and on_ready() are called on the connection's strand, one at a time; destroyed when the peer is gone.
class BodySource {
 public:
  virtual ~BodySource() = default;
  /// The next piece; empty = nothing now, ask again when woken; absent = the end.
  virtual std::optional<std::string> next() = 0;
  /// Who waits: `wake` may be called from any thread, also after the source's end, and more often than there is news.
  virtual void on_ready(std::function<void()> wake) = 0;
  /// Called about once a second while nothing was there to send: what keeps the line alive, or empty; absent = the end.
  virtual std::optional<std::string> idle() { return std::string(); }
};

struct Response {
  int status = 200;
  std::map<std::string, std::string> headers;
  std::string content_type = "application/json";
  std::string body;
  std::shared_ptr<BodySource> stream;                ///< instead of `body`
};

/// An RFC 9457 problem document; the status is the fault table's unless one is given.
Response problem(const Fault& fault, int status = 0);

/// Called exactly once, on any thread; server/net brings it back to the connection's strand.
using Respond = std::function<void(Response)>;

}  // namespace wayfuse
