#pragma once

#include <cstdint>
#include <string_view>

namespace wayfuse {

/// Which part of the data a walk belongs to, by the 64-bit FNV-1a hash of its id: a quarter tests, the rest surveys, and a
/// sixth of the survey is set apart as the development split. Nothing is ever tuned on kTest.
enum class Split : std::uint8_t { kSurvey, kDevelopment, kTest };
std::uint64_t fnv1a(std::string_view text);
Split split_of(std::string_view walk_id);
/// Which of `folds` folds a walk that is not tested on falls into; the development split is fold 0 of 6.
int fold_of(std::string_view walk_id, int folds);

}  // namespace wayfuse
