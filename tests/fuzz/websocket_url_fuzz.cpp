#include "sdk/src/client/websocket_url.hpp"

#include "tests/fuzz/promises.hpp"

using namespace wayfuse;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto url = parse_websocket_url(fuzzing::as_text(data, size));
  if (!url) {
    fuzzing::fault_is_presentable(url.fault());
    return 0;
  }
  // What goes into a request's head must not end a line of it.
  for (const std::string* part : {&url->host, &url->port, &url->path, &url->host_header}) {
    fuzzing::demand(part->find_first_of(std::string_view("\r\n\0 ", 4)) == std::string::npos, "one word", *part);
  }
  fuzzing::demand(!url->host.empty() && !url->port.empty() && url->path.starts_with('/'), "a whole address");
  return 0;
}
