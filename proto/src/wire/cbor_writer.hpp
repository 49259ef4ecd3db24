#pragma once

#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/scan.hpp"

namespace wayfuse::wire {

/// Spells values as CBOR with definite lengths and shortest heads [RFC 8949 section 4.1]. A number without a fraction is an
/// integer, others take four bytes where that loses nothing, else eight.
class CborWriter {
 public:
  CborWriter() { out_.reserve(768); }

  void begin_map() {
    maps_.push_back({out_.size(), 0});
    out_ += '\0';  // the head: written when the pairs are known, which are 23 at most
  }
  void end_map() {
    assert(maps_.back().pairs < 24);
    out_[maps_.back().head] = static_cast<char>(0xa0 | maps_.back().pairs);
    maps_.pop_back();
  }
  void begin_list(std::size_t size) { head(4, size); }
  void end_list() {}
  void key(std::string_view name) {
    ++maps_.back().pairs;
    string(3, name);
  }
  void integer(std::int64_t value) {
    if (value < 0) {
      head(1, static_cast<std::uint64_t>(-1 - value));
    } else {
      head(0, static_cast<std::uint64_t>(value));
    }
  }
  void real(double value) {
    if (value == std::floor(value) && std::fabs(value) < 9e15) return integer(static_cast<std::int64_t>(value));
    const auto narrow = static_cast<float>(value);
    if (static_cast<double>(narrow) == value) {
      out_ += static_cast<char>(0xfa);
      big_endian(std::bit_cast<std::uint32_t>(narrow), 4);
    } else {
      out_ += static_cast<char>(0xfb);
      big_endian(std::bit_cast<std::uint64_t>(value), 8);
    }
  }
  void flag(bool value) { out_ += static_cast<char>(value ? 0xf5 : 0xf4); }
  void address(Bssid bssid) {
    head(2, 6);
    big_endian(bssid.value, 6);
  }
  void bytes(std::string_view bytes) { string(2, bytes); }
  void text(std::string_view text) { string(3, text); }

  std::string take() { return std::move(out_); }

 private:
  struct Map {
    std::size_t head;
    unsigned pairs;
  };
  void big_endian(std::uint64_t value, int width) {
    for (int shift = 8 * (width - 1); shift >= 0; shift -= 8) out_ += static_cast<char>(value >> shift & 0xff);
  }
  void head(unsigned major, std::uint64_t argument) {
    const unsigned high = major << 5;
    if (argument < 24) {
      out_ += static_cast<char>(high | argument);
      return;
    }
    const int power = argument <= 0xff ? 0 : argument <= 0xffff ? 1 : argument <= 0xffffffff ? 2 : 3;
    out_ += static_cast<char>(high | static_cast<unsigned>(24 + power));
    big_endian(argument, 1 << power);
  }
  void string(unsigned major, std::string_view content) {
    head(major, content.size());
    out_ += content;
  }

  std::string out_;
  std::vector<Map> maps_;
};

}  // namespace wayfuse::wire
