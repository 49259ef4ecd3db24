#pragma once

#include <cassert>
#include <utility>
#include <variant>

#include "wayfuse/proto/fault.hpp"

namespace wayfuse {

/// A value, or the fault that says why there is none. Bad input travels as a fault; a broken world throws.
///
/// Own and small, because the vocabulary and the SDK's core use the standard library only.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}          // NOLINT(google-explicit-constructor)
  Result(Fault fault) : content_(std::in_place_index<1>, std::move(fault)) {}      // NOLINT(google-explicit-constructor)

  bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  T& value() & { assert(has_value()); return *std::get_if<0>(&content_); }
  const T& value() const& { assert(has_value()); return *std::get_if<0>(&content_); }
  T&& value() && { assert(has_value()); return std::move(*std::get_if<0>(&content_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Fault& fault() const { assert(!has_value()); return *std::get_if<1>(&content_); }

 private:
  std::variant<T, Fault> content_;
};

/// Success without a value, or a fault.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Fault fault) : fault_(std::move(fault)), ok_(false) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const Fault& fault() const { assert(!ok_); return fault_; }

 private:
  Fault fault_;
  bool ok_ = true;
};

}  // namespace wayfuse
