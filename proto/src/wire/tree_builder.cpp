#include "proto/src/wire/tree_builder.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "proto/src/wire/text.hpp"

namespace wayfuse::wire {

TreeBuilder::TreeBuilder(std::string_view frame) : frame_(frame) { tree_.nodes.reserve(frame.size() / 5 + 16); }

void TreeBuilder::open(Kind kind) {
  assert(may_open());
  Node node;
  node.kind = kind;
  const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
  add(node);
  open_[depth_++] = index;
}

bool TreeBuilder::close() {
  const std::uint32_t index = open_[depth_ - 1];
  Node& node = tree_.nodes[index];
  node.end = static_cast<std::uint32_t>(tree_.nodes.size());
  if (node.kind == Kind::kMap) {
    assert(node.size % 2 == 0);
    if (!keys_differ(index)) return false;
    node.size /= 2;
  }
  --depth_;
  return true;
}

void TreeBuilder::add_text(Kind kind, std::string_view text) {
  Node node;
  node.kind = kind;
  node.size = static_cast<std::uint32_t>(text.size());
  node.text = text.data();
  add(node);
}

char* TreeBuilder::claim(std::size_t size) {
  if (!tree_.unescaped) tree_.unescaped = std::make_unique<char[]>(frame_.size());
  assert(claimed_ + size <= frame_.size());
  char* memory = tree_.unescaped.get() + claimed_;
  claimed_ += size;
  return memory;
}

bool TreeBuilder::keys_differ(std::uint32_t map) {
  constexpr std::size_t kFew = 24;  // our own maps: comparing pairs is cheaper than sorting
  std::string_view few[kFew];
  std::vector<std::string_view> many;
  const std::size_t count = tree_.nodes[map].size / 2;
  std::size_t seen = 0;
  for (std::uint32_t key = map + 1; seen < count; key = tree_.after(key + 1)) {
    const std::string_view name = tree_.nodes[key].view();
    if (count > kFew) {
      many.push_back(name);
    } else {
      for (std::size_t i = 0; i < seen; ++i) {
        if (few[i] == name) return fail(FaultCode::kDuplicateField, "key " + quoted(name) + " stands twice");
      }
      few[seen] = name;
    }
    ++seen;
  }
  std::ranges::sort(many);
  const auto twice = std::ranges::adjacent_find(many);
  return twice == many.end() || fail(FaultCode::kDuplicateField, "key " + quoted(*twice) + " stands twice");
}

std::string TreeBuilder::path() const {
  std::string path;
  for (int level = 0; level < depth_; ++level) {
    const std::uint32_t container = open_[level];
    const std::uint32_t inner = level + 1 < depth_ ? open_[level + 1] : static_cast<std::uint32_t>(tree_.nodes.size());
    const Node& node = tree_.nodes[container];
    if (node.kind == Kind::kList) {
      // An inner open container is the last element counted; otherwise the fault is in the element to come.
      path += '[' + std::to_string(level + 1 < depth_ ? node.size - 1 : node.size) + ']';
    } else if (level + 1 < depth_ || node.size % 2 == 1) {
      // The key stands right before the open value, or is the last node so far.
      path += (path.empty() ? "" : ".") + clipped(tree_.nodes[inner - 1].view(), 64);
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
  assert(depth_ == 0);
  return std::move(tree_);
}

}  // namespace wayfuse::wire
