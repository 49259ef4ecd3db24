#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <locale>
#include <sstream>
#include <string>

#include "proto/src/wire/text.hpp"
#include "proto/src/wire/tree_builder.hpp"

namespace wayfuse::wire {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

int hex_digit(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

char* append_utf8(char* out, unsigned code) {
  if (code < 0x80) {
    *out++ = static_cast<char>(code);
    return out;
  }
  if (code < 0x800) {
    *out++ = static_cast<char>(0xc0 | code >> 6);
  } else {
    if (code < 0x10000) {
      *out++ = static_cast<char>(0xe0 | code >> 12);
    } else {
      *out++ = static_cast<char>(0xf0 | code >> 18);
      *out++ = static_cast<char>(0x80 | (code >> 12 & 63));
    }
    *out++ = static_cast<char>(0x80 | (code >> 6 & 63));
  }
  *out++ = static_cast<char>(0x80 | (code & 63));
  return out;
}

// Correctly rounded; false = beyond a double, on either side.
bool read_double(const char* begin, const char* end, double& value) {
#ifdef __cpp_lib_to_chars
  return std::from_chars(begin, end, value).ec == std::errc{};
#else  // libc++ before 20, as in Android's toolchain
  std::istringstream text(std::string(begin, end));
  text.imbue(std::locale::classic());
  return static_cast<bool>(text >> value) && value != 0.0;
#endif
}

// What a number's text means beyond the fast path: correctly rounded, infinite beyond a double, 0 below its least.
double slow_number(const char* begin, const char* end) {
  double value = 0.0;
  if (read_double(begin, end, value)) return value;
  // Out of range: look where the first significant digit stands, to see on which side.
  const bool negative = *begin == '-';
  long exponent = 0;
  bool significant = false;
  bool fraction = false;
  const char* at = begin + (negative ? 1 : 0);
  for (; at != end && *at != 'e' && *at != 'E'; ++at) {
    if (*at == '.') {
      fraction = true;
    } else {
      significant = significant || *at != '0';
      if (fraction && !significant) --exponent;
      if (!fraction && significant) ++exponent;
    }
  }
  if (at != end) {
    const bool down = at[1] == '-';
    long written = 0;
    for (at += at[1] == '-' || at[1] == '+' ? 2 : 1; at != end && written < 1'000'000; ++at)
      written = written * 10 + (*at - '0');
    exponent += down ? -written : written;
  }
  if (!significant || exponent < 0) return 0.0;
  return negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
}

// A value takes a byte at least, and so does what stands between two or closes one: hence the bound on nodes.
class JsonParser {
 public:
  explicit JsonParser(std::string_view frame)
      : begin_(frame.data()),
        at_(frame.data()),
        end_(frame.data() + frame.size()),
        builder_(frame, frame.size() / 2 + Limits::kDepth + 1) {}

  Result<Tree> run() { return builder_.finish(document()); }

 private:
  bool document() {
    skip_blanks();
    if (!value()) return false;
    skip_blanks();
    return at_ == end_ || malformed("bytes follow the end of the message");
  }

  bool malformed(const std::string& cause) {
    return builder_.fail(FaultCode::kMalformed, "byte " + std::to_string(at_ - begin_) + ": " + cause);
  }
  bool unexpected(const char* wanted) {
    if (at_ == end_) return malformed(std::string("the message ends where ") + wanted + " is expected");
    return malformed(std::string(wanted) + " is expected, not " + quoted(std::string_view(at_, 1)));
  }

  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) ++at_;
  }

  bool value() {
    if (at_ == end_) return unexpected("a value");
    switch (*at_) {
      case '{':
        return map();
      case '[':
        return list();
      case '"':
        return text(false);
      case 't':
        return word("true", Kind::kTrue);
      case 'f':
        return word("false", Kind::kFalse);
      case 'n':
        return word("null", Kind::kNull);
      default:
        return *at_ == '-' || is_digit(*at_) ? number() : unexpected("a value");
    }
  }

  bool word(std::string_view word, Kind kind) {
    if (std::string_view(at_, static_cast<std::size_t>(end_ - at_)).substr(0, word.size()) != word)
      return unexpected("a value");
    at_ += word.size();
    builder_.add(kind);
    return true;
  }

  bool open(Kind kind) {
    if (!builder_.may_open()) {
      return builder_.fail(FaultCode::kTooLarge, "nested deeper than " + std::to_string(Limits::kDepth) + " levels");
    }
    builder_.open(kind);
    ++at_;
    skip_blanks();
    return true;
  }

  bool map() {
    if (!open(Kind::kMap)) return false;
    if (at_ != end_ && *at_ == '}') {
      ++at_;
      return builder_.close();
    }
    while (true) {
      if (at_ == end_ || *at_ != '"') return unexpected("a key in quotes");
      if (!text(true)) return false;
      skip_blanks();
      if (at_ == end_ || *at_ != ':') return unexpected("':'");
      ++at_;
      skip_blanks();
      if (!value()) return false;
      skip_blanks();
      if (at_ == end_ || (*at_ != ',' && *at_ != '}')) return unexpected("',' or '}'");
      if (*at_++ == '}') return builder_.close();
      skip_blanks();
    }
  }

  bool list() {
    if (!open(Kind::kList)) return false;
    if (at_ != end_ && *at_ == ']') {
      ++at_;
      return builder_.close();
    }
    while (true) {
      if (!value()) return false;
      skip_blanks();
      if (at_ == end_ || (*at_ != ',' && *at_ != ']')) return unexpected("',' or ']'");
      if (*at_++ == ']') return builder_.close();
      skip_blanks();
    }
  }

  bool text(bool is_key) {
    const char* const what = is_key ? "a key" : "a text";
    const char* const start = ++at_;
    const bool ascii = run_to_special();
    if (at_ == end_) return malformed(std::string("the message ends inside ") + what);
    if (static_cast<unsigned char>(*at_) < 0x20) return malformed(std::string("a bare control character inside ") + what);
    std::string_view content(start, static_cast<std::size_t>(at_ - start));
    const bool escaped = *at_ == '\\';
    if (escaped && !unescape(start, what, content)) return false;
    ++at_;
    if ((escaped || !ascii) && !is_utf8(content))
      return builder_.fail(FaultCode::kBadText, std::string(what) + " is not UTF-8");
    if (is_key) {
      builder_.add_key(content);
    } else {
      builder_.add_text(Kind::kText, content);
    }
    return true;
  }

  // Goes to the next quote, backslash, control character or the end; false = a byte beyond ASCII may stand before it.
  bool run_to_special() {
    constexpr std::uint64_t kOnes = 0x0101010101010101u;
    constexpr std::uint64_t kHighs = 0x8080808080808080u;
    std::uint64_t seen = 0;
    if constexpr (std::endian::native == std::endian::little) {
      while (end_ - at_ >= 8) {
        std::uint64_t eight;
        std::memcpy(&eight, at_, 8);
        const std::uint64_t quote = eight ^ (kOnes * '"');
        const std::uint64_t backslash = eight ^ (kOnes * '\\');
        // The high bit of the first byte that is zero, zero, or below 0x20; bytes above it may be wrong and do not matter.
        const std::uint64_t special =
            (((quote - kOnes) & ~quote) | ((backslash - kOnes) & ~backslash) | ((eight - kOnes * 0x20) & ~eight)) & kHighs;
        seen |= eight;
        if (special != 0) {
          at_ += std::countr_zero(special) / 8;
          return (seen & kHighs) == 0;
        }
        at_ += 8;
      }
    }
    while (at_ != end_ && *at_ != '"' && *at_ != '\\' && static_cast<unsigned char>(*at_) >= 0x20) {
      seen |= static_cast<unsigned char>(*at_++);
    }
    return (seen & kHighs) == 0;
  }

  // Stands at the first backslash; leaves at_ on the closing quote.
  bool unescape(const char* start, const char* what, std::string_view& content) {
    const char* closing = at_;
    while (closing != end_ && *closing != '"') closing += *closing == '\\' && closing + 1 != end_ ? 2 : 1;
    if (closing == end_) return malformed(std::string("the message ends inside ") + what);
    char* const memory =
        builder_.claim(static_cast<std::size_t>(closing - start));  // an escape is never shorter than what it means
    char* out = std::copy(start, at_, memory);
    while (*at_ != '"') {
      if (static_cast<unsigned char>(*at_) < 0x20) return malformed(std::string("a bare control character inside ") + what);
      if (*at_ != '\\') {
        *out++ = *at_++;
      } else if (!escape(out)) {
        return false;
      }
    }
    content = std::string_view(memory, static_cast<std::size_t>(out - memory));
    return true;
  }

  bool escape(char*& out) {
    constexpr std::string_view kLetters = "\"\\/bfnrt";
    constexpr std::string_view kMeanings = "\"\\/\b\f\n\r\t";
    const std::size_t letter = kLetters.find(at_[1]);
    if (letter != std::string_view::npos) {
      *out++ = kMeanings[letter];
      at_ += 2;
      return true;
    }
    if (at_[1] != 'u') return malformed("an escape that JSON does not know");
    int high = code_unit();
    if (high < 0) return malformed("\\u needs four hexadecimal digits");
    auto code = static_cast<unsigned>(high);
    if (code >= 0xd800 && code < 0xdc00) {
      const int low = end_ - at_ >= 6 && at_[0] == '\\' && at_[1] == 'u' ? code_unit() : -1;
      if (low < 0xdc00 || low > 0xdfff) return builder_.fail(FaultCode::kBadText, "half of a surrogate pair");
      code = 0x10000 + ((code - 0xd800) << 10) + (static_cast<unsigned>(low) - 0xdc00);
    } else if (code >= 0xdc00 && code < 0xe000) {
      return builder_.fail(FaultCode::kBadText, "half of a surrogate pair");
    }
    out = append_utf8(out, code);
    return true;
  }

  // Reads \uXXXX at at_ and goes past it; -1 = not four digits.
  int code_unit() {
    if (end_ - at_ < 6) return -1;
    int code = 0;
    for (int i = 2; i < 6; ++i) {
      const int digit = hex_digit(at_[i]);
      if (digit < 0) return -1;
      code = code * 16 + digit;
    }
    at_ += 6;
    return code;
  }

  bool number() {
    const char* const start = at_;
    const bool negative = *at_ == '-';
    if (negative) ++at_;
    if (at_ == end_ || !is_digit(*at_)) return unexpected("a digit");
    std::uint64_t digits = 0;  // wraps beyond 19 digits; then the slow path reads the text again
    const char* const first = at_;
    if (*at_ == '0' && at_ + 1 != end_ && is_digit(at_[1])) return malformed("a number does not begin with 0");
    while (at_ != end_ && is_digit(*at_)) digits = digits * 10 + static_cast<unsigned>(*at_++ - '0');
    auto count = at_ - first;
    std::ptrdiff_t decimals = 0;
    if (at_ != end_ && *at_ == '.') {
      const char* const point = ++at_;
      while (at_ != end_ && is_digit(*at_)) digits = digits * 10 + static_cast<unsigned>(*at_++ - '0');
      decimals = at_ - point;
      if (decimals == 0) return unexpected("a digit");
      count += decimals;
    }
    const bool exponent = at_ != end_ && (*at_ == 'e' || *at_ == 'E');
    if (exponent) {
      ++at_;
      if (at_ != end_ && (*at_ == '+' || *at_ == '-')) ++at_;
      if (at_ == end_ || !is_digit(*at_)) return unexpected("a digit");
      while (at_ != end_ && is_digit(*at_)) ++at_;
    }
    add_number(start, negative, digits, count, decimals, exponent);
    return true;
  }

  void add_number(const char* start, bool negative, std::uint64_t digits, std::ptrdiff_t count, std::ptrdiff_t decimals,
                  bool exponent) {
    static constexpr double kPowers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    if (!exponent && decimals == 0 && count <= 18) {
      builder_.add_integer(negative ? -static_cast<std::int64_t>(digits) : static_cast<std::int64_t>(digits));
    } else if (!exponent && count <= 15) {  // both exact, so the quotient is rounded once [Clinger 1990]
      const double magnitude = static_cast<double>(digits) / kPowers[decimals];
      builder_.add_real(negative ? -magnitude : magnitude);
    } else {
      builder_.add_real(slow_number(start, at_));
    }
  }

  const char* begin_;
  const char* at_;
  const char* end_;
  TreeBuilder builder_;
};

}  // namespace

Result<Tree> parse_json(std::string_view frame) {
  return JsonParser(frame).run();
}

}  // namespace wayfuse::wire
