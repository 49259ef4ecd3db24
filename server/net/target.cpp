#include "server/net/target.hpp"

#include <algorithm>
#include <optional>

namespace wayfuse {
namespace {

int digit_of(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
  if (letter >= 'A' && letter <= 'F') return letter - 'A' + 10;
  return -1;
}

std::optional<std::string> decode_percent(std::string_view text, bool plus_is_space) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char letter = text[i];
    if (letter == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = digit_of(text[i + 1]);
      const int low = digit_of(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      letter = static_cast<char>(high * 16 + low);
      i += 2;
    } else if (letter == '+' && plus_is_space) {
      letter = ' ';
    }
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f) return std::nullopt;
    decoded.push_back(letter);
  }
  return decoded;
}

bool climbs(std::string_view path) {
  while (!path.empty()) {
    path.remove_prefix(1);
    const std::string_view segment = path.substr(0, path.find('/'));
    if (segment == "." || segment == "..") return true;
    path.remove_prefix(segment.size());
  }
  return false;
}

}  // namespace

Result<Target> parse_target(std::string_view target) {
  const auto refuse = [](const char* cause) { return Fault{FaultCode::kMalformed, "target", cause}; };
  if (target.empty() || target.front() != '/') return refuse("must begin with a slash");
  target = target.substr(0, target.find('#'));
  const std::size_t mark = std::min(target.find('?'), target.size());
  auto path = decode_percent(target.substr(0, mark), false);
  if (!path) return refuse("a broken escape or a control character in the path");
  if (climbs(*path)) return refuse("`.` and `..` lead nowhere here");
  Target parsed{*std::move(path), {}};
  std::string_view rest = mark < target.size() ? target.substr(mark + 1) : std::string_view();
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
    if (pair.empty()) continue;
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const auto name = decode_percent(pair.substr(0, equals), true);
    const auto value = decode_percent(equals < pair.size() ? pair.substr(equals + 1) : std::string_view(), true);
    if (!name || !value) return refuse("a broken escape or a control character in the query");
    if (!parsed.query.emplace(*name, *value).second) return refuse("a query parameter stands twice");
  }
  return parsed;
}

std::string_view bearer_token(std::string_view authorization) {
  constexpr std::string_view kScheme = "bearer ";
  if (authorization.size() <= kScheme.size()) return {};
  const bool bearer = std::ranges::equal(authorization.substr(0, kScheme.size()), kScheme, [](char given, char wanted) {
    return (given >= 'A' && given <= 'Z' ? given + ('a' - 'A') : given) == wanted;
  });
  return bearer ? authorization.substr(kScheme.size()) : std::string_view();
}

}  // namespace wayfuse
