#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "proto/src/wire/kinds.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse::wire {

/// One step of the way into a message.
struct Step {
  const Step* outer = nullptr;
  std::string_view name;      ///< empty = the message itself
  std::ptrdiff_t index = -1;  ///< of an element; -1 = the field as a whole
};

/// The way of a visitor into a message, and the first fault met on it. After a fault every further visit does nothing.
class Trail {
 public:
  explicit Trail(std::string_view root) : root_(root) {}

  bool failed() const { return failed_; }
  Fault take_fault() { return std::move(fault_); }

  void fail(const Step& at, FaultCode code, std::string cause) {
    if (failed_) return;
    failed_ = true;
    fault_ = Fault{code, path(at), std::move(cause)};
  }
  /// False = refused.
  bool pass(const Step& at, std::optional<Refusal> refusal) {
    if (!refusal) return true;
    fail(at, refusal->code, std::move(refusal->cause));
    return false;
  }

 private:
  std::string path(const Step& at) const {
    std::string text = at.outer ? path(*at.outer) : std::string(root_);
    if (!at.name.empty()) {
      if (!text.empty()) text += '.';
      text += at.name;
    }
    if (at.index >= 0) text += '[' + std::to_string(at.index) + ']';
    return text;
  }

  std::string_view root_;
  bool failed_ = false;
  Fault fault_;
};

}  // namespace wayfuse::wire
