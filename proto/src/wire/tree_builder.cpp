#include "proto/src/wire/tree_builder.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "proto/src/wire/text.hpp"

namespace wayfuse::wire {

TreeBuilder::TreeBuilder(std::string_view frame, std::size_t most_nodes) : frame_(frame), most_nodes_(most_nodes) {
  tree_.nodes = std::make_unique_for_overwrite<Node[]>(most_nodes);
}

void TreeBuilder::open(Kind kind) {
  assert(may_open());
  const std::uint32_t node = count_;
  next(kind);
  open_[++depth_] = Open{kind, false, node, 0, 0};
}

bool TreeBuilder::close() {
  const Open& container = open_[depth_];
  Node& node = tree_.nodes[container.node];
  node.end = count_;
  node.size = container.members;
  if (container.kind == Kind::kMap) {
    assert(container.members % 2 == 0);
    node.size /= 2;
    if (container.keys_alike && !keys_differ(container)) return false;
  }
  --depth_;
  return true;
}

char* TreeBuilder::claim(std::size_t size) {
  if (!tree_.unescaped) tree_.unescaped = std::make_unique_for_overwrite<char[]>(frame_.size());
  assert(claimed_ + size <= frame_.size());
  char* memory = tree_.unescaped.get() + claimed_;
  claimed_ += size;
  return memory;
}

bool TreeBuilder::keys_differ(const Open& map) {
  std::vector<std::string_view> keys;
  keys.reserve(map.members / 2);
  for (std::uint32_t key = map.node + 1; key < count_; key = tree_.after(key + 1)) keys.push_back(tree_.nodes[key].view());
  std::ranges::sort(keys);
  const auto twice = std::ranges::adjacent_find(keys);
  return twice == keys.end() || fail(FaultCode::kDuplicateField, "key " + quoted(*twice) + " stands twice");
}

std::string TreeBuilder::path() const {
  std::string path;
  for (int level = 1; level <= depth_; ++level) {
    const Open& container = open_[level];
    const bool innermost = level == depth_;
    if (container.kind == Kind::kList) {
      // An inner open container is the last element counted; otherwise the fault is in the element to come.
      path += '[' + std::to_string(innermost ? container.members : container.members - 1) + ']';
    } else if (!innermost || container.members % 2 == 1) {
      // The key stands right before the open value, or is the last node so far.
      const std::uint32_t value = innermost ? count_ : open_[level + 1].node;
      path += (path.empty() ? "" : ".") + clipped(tree_.nodes[value - 1].view(), 64);
    }
  }
  return path;
}

bool TreeBuilder::fail(FaultCode code, std::string cause) {
  fault_ = Fault{code, path(), std::move(cause)};
  return false;
}

Result<Tree> TreeBuilder::finish(bool parsed) {
  if (!parsed) return std::move(fault_);
  assert(depth_ == 0 && count_ > 0);
  return std::move(tree_);
}

}  // namespace wayfuse::wire
