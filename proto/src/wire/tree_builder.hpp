#pragma once

#include <string>
#include <string_view>

#include "proto/src/wire/tree.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse::wire {

/// What both parsers share: containers open and close, keys are compared, the path of a fault is known.
///
/// Thread: confined to one parse.
class TreeBuilder {
 public:
  explicit TreeBuilder(std::string_view frame);

  /// Room left for another container inside?
  bool may_open() const { return depth_ < Limits::kDepth; }
  void open(Kind kind);
  /// Ends the innermost container. False = a key stands twice in it; `fault()` then says which.
  bool close();
  void add(const Node& node) {
    tree_.nodes.push_back(node);
    if (depth_ > 0) ++tree_.nodes[open_[depth_ - 1]].size;  // of a map: keys and values, halved when it closes
  }
  void add_text(Kind kind, std::string_view text);

  bool inside_map() const { return depth_ > 0 && tree_.nodes[open_[depth_ - 1]].kind == Kind::kMap; }
  /// In a map: does a key come next?
  bool at_key() const { return inside_map() && tree_.nodes[open_[depth_ - 1]].size % 2 == 0; }
  std::uint32_t members() const { return tree_.nodes[open_[depth_ - 1]].size; }
  int depth() const { return depth_; }
  /// Memory for `size` bytes of text that does not stand in the frame; all of it together never exceeds the frame.
  char* claim(std::size_t size);

  /// Remembers what went wrong and where; answers false, so that a parser can return it.
  bool fail(FaultCode code, std::string cause);
  Result<Tree> finish(bool parsed);

 private:
  std::string path() const;
  bool keys_differ(std::uint32_t map);

  std::string_view frame_;
  Tree tree_;
  std::size_t claimed_ = 0;
  std::uint32_t open_[Limits::kDepth] = {};
  int depth_ = 0;
  Fault fault_;
};

}  // namespace wayfuse::wire
