#include "server/net/target.hpp"

#include "tests/fuzz/promises.hpp"

using namespace wayfuse;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzzing::as_text(data, size);
  const std::string_view token = bearer_token(text);
  fuzzing::demand(token.size() <= text.size(), "a token is part of its header");
  const auto target = parse_target(text);
  if (!target) {
    fuzzing::fault_is_presentable(target.fault());
    return 0;
  }
  fuzzing::demand(target->path.starts_with('/'), "a path begins with a slash", target->path);
  const std::string inside = target->path + '/';
  fuzzing::demand(inside.find("/../") == std::string::npos && inside.find("/./") == std::string::npos, "no path climbs",
                  target->path);
  fuzzing::demand(target->path.find('\0') == std::string::npos, "no path holds a zero");
  return 0;
}
