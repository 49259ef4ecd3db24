#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "proto/src/wire/text.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse::wire {

/// Spells values as JSON without blanks. Precondition: texts are UTF-8, numbers finite.
class JsonWriter {
 public:
  JsonWriter() { out_.reserve(1024); }  // a batch of a second or two

  void begin_map() { begin('{'); }
  void end_map() { end('}'); }
  void begin_list(std::size_t) { begin('['); }
  void end_list() { end(']'); }

  void key(std::string_view name) {
    separate();
    out_ += '"';
    out_ += name;  // our own field names: nothing to escape
    out_ += "\":";
    after_key_ = true;
  }
  void integer(std::int64_t value) {
    separate();
    char digits[24];
    out_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }
  void real(double value) {
    separate();
    append_number(out_, value);
  }
  void flag(bool value) {
    separate();
    out_ += value ? "true" : "false";
  }
  void address(Bssid bssid) {
    separate();
    out_ += '"';
    out_ += to_string(bssid);
    out_ += '"';
  }
  void bytes(std::string_view bytes) {
    separate();
    out_ += '"';
    out_ += to_base64(bytes);
    out_ += '"';
  }
  void text(std::string_view text) {
    separate();
    out_ += '"';
    for (const char c : text) {
      if (c == '"' || c == '\\') {
        out_ += '\\';
        out_ += c;
      } else if (static_cast<unsigned char>(c) < 0x20) {
        constexpr std::string_view kDigits = "0123456789abcdef";
        out_ += "\\u00";
        out_ += kDigits[static_cast<unsigned char>(c) >> 4];
        out_ += kDigits[static_cast<unsigned char>(c) & 15u];
      } else {
        out_ += c;
      }
    }
    out_ += '"';
  }

  std::string take() { return std::move(out_); }

 private:
  void separate() {
    if (!after_key_ && !first_) out_ += ',';
    after_key_ = false;
    first_ = false;
  }
  void begin(char bracket) {
    separate();
    out_ += bracket;
    first_ = true;
  }
  void end(char bracket) {
    out_ += bracket;
    first_ = false;
  }

  std::string out_;
  bool first_ = true;
  bool after_key_ = false;
};

}  // namespace wayfuse::wire
