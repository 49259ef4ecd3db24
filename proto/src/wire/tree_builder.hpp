#pragma once

#include <cassert>
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
  /// `most_nodes`: an upper bound for this frame, given by what the encoding needs for one.
  TreeBuilder(std::string_view frame, std::size_t most_nodes);

  /// Room left for another container inside?
  bool may_open() const { return depth_ < Limits::kDepth; }
  void open(Kind kind);
  /// Ends the innermost container. False = a key stands twice in it.
  bool close();

  void add(Kind kind) { next(kind); }
  void add_integer(std::int64_t value) { next(Kind::kInteger).integer = value; }
  void add_real(double value) { next(Kind::kReal).real = value; }
  void add_text(Kind kind, std::string_view text) {
    Node& node = next(kind);
    node.size = static_cast<std::uint32_t>(text.size());
    node.text = text.data();
  }
  void add_key(std::string_view key) {
    Open& map = open_[depth_];
    const std::uint64_t mark = std::uint64_t{1} << signature(key);
    map.keys_alike = map.keys_alike || (map.marks & mark) != 0;
    map.marks |= mark;
    add_text(Kind::kText, key);
  }

  /// In a map: does a key come next?
  bool at_key() const { return open_[depth_].kind == Kind::kMap && open_[depth_].members % 2 == 0; }
  /// So far in the innermost container; a map's keys and values count one by one.
  std::uint32_t members() const { return open_[depth_].members; }
  /// Memory for `size` bytes of text that does not stand in the frame; all of it together never exceeds the frame.
  char* claim(std::size_t size);

  /// Remembers what went wrong and where; answers false, so that a parser can return it.
  bool fail(FaultCode code, std::string cause);
  Result<Tree> finish(bool parsed);

 private:
  /// A container not yet closed; the outermost is the frame itself.
  struct Open {
    Kind kind = Kind::kList;
    bool keys_alike = false;  ///< two keys have the same signature: they must be compared
    std::uint32_t node = 0;
    std::uint32_t members = 0;
    std::uint64_t marks = 0;  ///< signatures of the keys so far
  };

  Node& next(Kind kind) {
    assert(count_ < most_nodes_);
    ++open_[depth_].members;
    Node& node = tree_.nodes[count_++];
    node.kind = kind;
    return node;
  }
  /// 0..63; our own keys of one map differ in it more often than not.
  static unsigned signature(std::string_view key) {
    if (key.empty()) return 0;
    const auto first = static_cast<unsigned char>(key.front());
    const auto last = static_cast<unsigned char>(key.back());
    return (first * 5u + last * 3u + static_cast<unsigned>(key.size()) * 7u) & 63u;
  }
  bool keys_differ(const Open& map);
  std::string path() const;

  std::string_view frame_;
  Tree tree_;
  std::size_t most_nodes_;
  std::uint32_t count_ = 0;
  std::size_t claimed_ = 0;
  int depth_ = 0;
  Open open_[Limits::kDepth + 1];
  Fault fault_;
};

}  // namespace wayfuse::wire
