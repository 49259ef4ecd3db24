#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace wayfuse {

/// Working memory that is no state: a copy of its owner begins without any, and keeps what it has when assigned to.
///
/// Sessions keep copies of their trackers to go back to; only what a tracker knows is worth their memory.
template <typename T>
class Scratch {
 public:
  Scratch() = default;
  Scratch(const Scratch&) {}
  Scratch& operator=(const Scratch&) { return *this; }
  /// `size` entries, their values unspecified. Allocates until it has been asked for as many once.
  std::span<T> get(std::size_t size) {
    if (values_.size() < size) values_.resize(size);
    return {values_.data(), size};
  }
  /// Trades places with a column of get()'s size.
  void swap(std::vector<T>& column) { values_.swap(column); }

 private:
  std::vector<T> values_;
};

}  // namespace wayfuse
