#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "admin/http.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

/// Numbers in a request's query; what does not serve is a fault that names the parameter.
namespace wayfuse {

template <typename Number>
Result<Number> number_in(const Request& request, const char* name, Number standard, Number least, Number most) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return standard;
  Number value{};
  const char* end = found->second.data() + found->second.size();
  const auto [stop, error] = std::from_chars(found->second.data(), end, value);
  if (error != std::errc{} || stop != end || !(value >= least && value <= most)) {
    return Fault{FaultCode::kOutOfRange, name,
                 "'" + found->second + "' is no number in " + std::to_string(least) + ".." + std::to_string(most)};
  }
  return value;
}

inline Result<std::optional<FloorOrdinal>> floor_in(const Request& request) {
  if (!request.query.contains("floor")) return std::optional<FloorOrdinal>();
  const auto floor = number_in<std::int32_t>(request, "floor", 0, -100, 300);
  if (!floor) return floor.fault();
  return std::optional(FloorOrdinal{*floor});
}

/// `?dry_run=1` and its like; absent = false.
inline Result<bool> flag_in(const Request& request, const char* name) {
  const auto found = request.query.find(name);
  if (found == request.query.end() || found->second == "0" || found->second == "false") return false;
  if (found->second == "1" || found->second == "true" || found->second.empty()) return true;
  return Fault{FaultCode::kOutOfRange, name, "'" + found->second + "' is neither 1 nor 0"};
}

/// Where a list is read on, and how much of it.
struct Page {
  std::uint64_t after = 0;         ///< exclusive
  std::uint32_t most = 100;
};
inline Result<Page> page_in(const Request& request) {
  const auto after = number_in<std::uint64_t>(request, "after", 0, 0, INT64_MAX);
  if (!after) return after.fault();
  const auto most = number_in<std::uint32_t>(request, "most", 100, 1, 1000);
  if (!most) return most.fault();
  return Page{*after, *most};
}

/// For lists that are short and known whole: a page where `most` is asked for, else everything there is after `after`.
inline Result<Page> page_asked_in(const Request& request) {
  auto page = page_in(request);
  if (page && !request.query.contains("most")) page->most = UINT32_MAX;
  return page;
}

/// Cuts a list, ascending by what `id_of` says, to a page; answers the `after` to go on with, 0 at the end.
template <typename Entry, typename IdOf>
std::uint64_t cut_to(const Page& page, std::vector<Entry>& entries, IdOf id_of) {
  std::erase_if(entries, [&](const Entry& entry) { return id_of(entry) <= page.after; });
  if (entries.size() <= page.most) return 0;
  entries.erase(entries.begin() + page.most, entries.end());
  return id_of(entries.back());
}

}  // namespace wayfuse
