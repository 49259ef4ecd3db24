#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "proto/src/wire/text.hpp"
#include "proto/src/wire/tree_builder.hpp"

namespace wayfuse::wire {
namespace {

// IEEE 754 binary16 [RFC 8949 appendix D].
double half_to_double(unsigned half) {
  const unsigned exponent = half >> 10 & 31u;
  const unsigned fraction = half & 1023u;
  double value;
  if (exponent == 0) {
    value = std::ldexp(fraction, -24);
  } else if (exponent < 31) {
    value = std::ldexp(fraction + 1024, static_cast<int>(exponent) - 25);
  } else {
    value = fraction == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  }
  return half & 0x8000u ? -value : value;
}

enum Major : unsigned { kUnsigned, kNegative, kByteString, kTextString, kArray, kMapping, kTag, kSimple };

// The head of one data item.
struct Head {
  unsigned major = 0;
  unsigned info = 0;  ///< the low five bits
  std::uint64_t argument = 0;
  bool indefinite() const { return info == 31; }
};

// A value takes a byte at least: hence the bound on nodes.
class CborParser {
 public:
  explicit CborParser(std::string_view frame) : frame_(frame), builder_(frame, frame.size() + 1) {}

  Result<Tree> run() { return builder_.finish(document()); }

 private:
  bool document() {
    if (!item()) return false;
    return at_ == frame_.size() || malformed("bytes follow the end of the message");
  }

  bool malformed(const std::string& cause) {
    return builder_.fail(FaultCode::kMalformed, "byte " + std::to_string(at_) + ": " + cause);
  }
  std::uint64_t left() const { return frame_.size() - at_; }

  bool head(Head& head) {
    if (left() == 0) return malformed("the message ends where a value is expected");
    const auto initial = static_cast<unsigned char>(frame_[at_]);
    head.major = initial >> 5;
    head.info = initial & 31u;
    head.argument = head.info;
    if (head.info >= 24) return long_head(head);
    ++at_;
    return true;
  }
  bool long_head(Head& head) {
    if (head.info > 27) {
      const bool may_be_indefinite = head.major >= kByteString && head.major != kTag;
      if (head.info != 31 || !may_be_indefinite) return malformed("a reserved length");
      ++at_;
      return true;
    }
    const std::size_t width = std::size_t{1} << (head.info - 24);
    if (left() < 1 + width) return malformed("the message ends inside a head");
    ++at_;
    head.argument = 0;
    for (std::size_t i = 0; i < width; ++i) head.argument = head.argument << 8 | static_cast<unsigned char>(frame_[at_++]);
    return true;
  }

  bool item() {
    Head h;
    if (!head(h)) return false;
    if (builder_.at_key() && h.major != kTextString) return malformed("a key that is not a text");
    switch (h.major) {
      case kUnsigned:
      case kNegative:
        return integer(h);
      case kByteString:
      case kTextString:
        return text(h);
      case kArray:
      case kMapping:
        return container(h);
      case kTag:
        return malformed("tag " + std::to_string(h.argument) + ": this protocol has no tags");
      default:
        return simple(h);
    }
  }

  bool integer(const Head& h) {
    if (h.argument <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      const auto magnitude = static_cast<std::int64_t>(h.argument);
      builder_.add_integer(h.major == kNegative ? -1 - magnitude : magnitude);
    } else {  // far beyond every range here; only its being well formed matters
      const auto magnitude = static_cast<double>(h.argument);
      builder_.add_real(h.major == kNegative ? -1.0 - magnitude : magnitude);
    }
    return true;
  }

  bool chunk(const Head& h, std::string_view& content) {
    if (h.argument > left())
      return malformed("a text of " + std::to_string(h.argument) + " bytes, but only " + std::to_string(left()) + " follow");
    content = frame_.substr(at_, h.argument);
    if (h.major == kTextString && !is_utf8(content)) {
      return builder_.fail(FaultCode::kBadText, builder_.at_key() ? "a key is not UTF-8" : "a text is not UTF-8");
    }
    at_ += h.argument;
    return true;
  }

  bool text(const Head& h) {
    std::string_view content;
    if (h.indefinite() ? !chunks(h.major, content) : !chunk(h, content)) return false;
    if (builder_.at_key()) {
      builder_.add_key(content);
    } else {
      builder_.add_text(h.major == kTextString ? Kind::kText : Kind::kBytes, content);
    }
    return true;
  }

  // An indefinite text: definite chunks of the same kind, then a break.
  bool chunks(unsigned major, std::string_view& content) {
    const char* memory = nullptr;
    std::size_t size = 0;
    while (true) {
      if (left() > 0 && static_cast<unsigned char>(frame_[at_]) == 0xff) break;
      Head h;
      if (!head(h)) return false;
      if (h.major != major || h.indefinite()) return malformed("a chunk of another kind");
      std::string_view part;
      if (!chunk(h, part)) return false;
      char* const copy = builder_.claim(part.size());  // claims are adjacent
      if (memory == nullptr) memory = copy;
      std::memcpy(copy, part.data(), part.size());
      size += part.size();
    }
    ++at_;
    content = std::string_view(memory == nullptr ? frame_.data() : memory, size);
    return true;
  }

  bool container(const Head& h) {
    if (!builder_.may_open()) {
      return builder_.fail(FaultCode::kTooLarge, "nested deeper than " + std::to_string(Limits::kDepth) + " levels");
    }
    const bool map = h.major == kMapping;
    const std::uint64_t least_bytes = map ? 2 : 1;  // of one member
    if (!h.indefinite() && h.argument > left() / least_bytes) {
      return malformed(std::to_string(h.argument) + " members, but only " + std::to_string(left()) + " bytes follow");
    }
    builder_.open(map ? Kind::kMap : Kind::kList);
    const std::uint64_t wanted = h.indefinite() ? 0 : h.argument * least_bytes;
    while (h.indefinite() || builder_.members() < wanted) {
      if (h.indefinite() && left() > 0 && static_cast<unsigned char>(frame_[at_]) == 0xff) {
        if (map && builder_.members() % 2 != 0) return malformed("a key without a value");
        ++at_;
        break;
      }
      if (!item()) return false;
    }
    return builder_.close();
  }

  bool simple(const Head& h) {
    switch (h.info) {
      case 20:
        builder_.add(Kind::kFalse);
        return true;
      case 21:
        builder_.add(Kind::kTrue);
        return true;
      case 22:
        builder_.add(Kind::kNull);
        return true;
      case 25:
        builder_.add_real(half_to_double(static_cast<unsigned>(h.argument)));
        return true;
      case 26:
        builder_.add_real(std::bit_cast<float>(static_cast<std::uint32_t>(h.argument)));
        return true;
      case 27:
        builder_.add_real(std::bit_cast<double>(h.argument));
        return true;
      case 31:
        return malformed("a break outside an indefinite length");
      default:
        return malformed("simple value " + std::to_string(h.argument) + ": this protocol has none beyond false, true, null");
    }
  }

  std::string_view frame_;
  std::size_t at_ = 0;
  TreeBuilder builder_;
};

}  // namespace

Result<Tree> parse_cbor(std::string_view frame) {
  return CborParser(frame).run();
}

}  // namespace wayfuse::wire
