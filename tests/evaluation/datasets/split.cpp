#include "tests/evaluation/datasets/split.hpp"

namespace wayfuse {

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // offset basis and prime of the 64-bit variant (Fowler, Noll, Vo)
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3u;
  }
  return hash;
}

int fold_of(std::string_view walk_id, int folds) { return static_cast<int>((fnv1a(walk_id) >> 2) % static_cast<unsigned>(folds)); }

Split split_of(std::string_view walk_id) {
  if (fnv1a(walk_id) % 4 == 0) return Split::kTest;
  return fold_of(walk_id, 6) == 0 ? Split::kDevelopment : Split::kSurvey;
}

}  // namespace wayfuse
