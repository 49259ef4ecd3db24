#include "sdk/src/recording/import/floor_label.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <optional>
#include <set>

namespace wayfuse {
namespace {

// `B2` -> -2, `F1`, `1F`, `L1` -> 0, `G`, `GF` -> 0, `LG` -> -1; absent if the label says nothing.
std::optional<int> said_by(const std::string& label, bool ground_named) {
  std::string letters;
  std::string digits;
  for (const char c : label) {
    if (std::isalpha(static_cast<unsigned char>(c))) letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (std::isdigit(static_cast<unsigned char>(c))) digits += c;
  }
  if (digits.size() > 3) return std::nullopt;
  const int n = digits.empty() ? 0 : std::atoi(digits.c_str());
  if (letters == "G" || letters == "GF") return digits.empty() || n == 0 ? 0 : n - 1;
  if (letters == "LG" || letters == "LGF") return n == 0 ? -1 : -n;
  if (letters == "B" || letters == "BF") return n == 0 ? -1 : -n;
  if (digits.empty()) return std::nullopt;
  if (letters == "F" || letters == "L" || letters.empty()) return n == 0 ? 0 : ground_named ? n : n - 1;
  return std::nullopt;
}

bool names_ground(const std::string& label) {
  std::string upper;
  for (const char c : label) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper == "G" || upper == "GF";
}

}  // namespace

std::vector<FloorOrdinal> floor_ordinals(const std::vector<std::string>& labels) {
  const bool ground_named = std::any_of(labels.begin(), labels.end(), names_ground);
  std::vector<std::optional<int>> said;
  std::set<int> taken;
  for (const std::string& label : labels) {
    auto ordinal = said_by(label, ground_named);
    if (ordinal && !taken.insert(*ordinal).second) ordinal.reset();
    said.push_back(ordinal);
  }
  std::vector<std::size_t> silent;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!said[i]) silent.push_back(i);
  }
  std::sort(silent.begin(), silent.end(), [&](std::size_t a, std::size_t b) { return labels[a] < labels[b]; });
  int next = taken.empty() ? 0 : *taken.rbegin() + 1;
  for (const std::size_t i : silent) said[i] = next++;
  std::vector<FloorOrdinal> ordinals;
  for (const auto& ordinal : said) ordinals.push_back({*ordinal});
  return ordinals;
}

}  // namespace wayfuse
