#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "wayfuse/proto/result.hpp"

namespace wayfuse::wire {

/// What a parsed value is, in either encoding. Only CBOR has bytes.
enum class Kind : std::uint8_t { kNull, kFalse, kTrue, kInteger, kReal, kText, kBytes, kList, kMap };

/// One value of a parsed frame. A container is followed by its members; a map's members are key (kText) and value in turn.
struct Node {
  Kind kind;
  std::uint32_t size;  ///< bytes of a text, elements of a list, pairs of a map
  union {
    std::int64_t integer;
    double real;        ///< also integers beyond 64 bits; infinite where the text overflows a double
    const char* text;   ///< into the frame, or into the tree's own memory where the text had escapes
    std::uint32_t end;  ///< of a container: index of the first node after its members
  };

  std::string_view view() const { return {text, size}; }
  bool is_container() const { return kind == Kind::kList || kind == Kind::kMap; }
};

/// A parsed frame as one flat array in document order; the root is node 0.
///
/// Well formed, depth within its limit, texts UTF-8, no key twice in a map: the parsers saw to that. The frame must outlive it.
struct Tree {
  std::unique_ptr<Node[]> nodes;      ///< not initialised beyond the last one
  std::unique_ptr<char[]> unescaped;  ///< owns the texts that do not stand in the frame as they are

  /// Index of the value after the one at `index`.
  std::uint32_t after(std::uint32_t index) const { return nodes[index].is_container() ? nodes[index].end : index + 1; }
};

/// Strict RFC 8259: no comments, no trailing commas, one document, nothing after it.
Result<Tree> parse_json(std::string_view frame);
/// RFC 8949 without tags and simple values beyond false, true and null; keys are texts. Indefinite lengths are read.
Result<Tree> parse_cbor(std::string_view frame);

}  // namespace wayfuse::wire
