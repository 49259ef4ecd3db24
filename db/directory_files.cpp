#include "db/directory_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "db/sqlite.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "building-";
constexpr std::string_view kSuffix = ".sqlite";
constexpr std::string_view kCorrupt = ".sqlite.corrupt";

// `building-12.sqlite` with suffix `.sqlite` -> 12; absent for any other spelling, leading zeros included.
std::optional<BuildingId> id_in(std::string_view name, std::string_view suffix) {
  if (name.size() <= kPrefix.size() + suffix.size() || name.substr(0, kPrefix.size()) != kPrefix ||
      name.substr(name.size() - suffix.size()) != suffix) {
    return std::nullopt;
  }
  const std::string_view digits = name.substr(kPrefix.size(), name.size() - kPrefix.size() - suffix.size());
  BuildingId id;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), id.value);
  if (error != std::errc() || end != digits.data() + digits.size() || std::to_string(id.value) != digits || id.value == 0) {
    return std::nullopt;
  }
  return id;
}

[[noreturn]] void fail(const fs::path& folder, const std::error_code& error) {
  const int code = error.value();
  const bool full = code == ENOSPC || code == EDQUOT || code == EROFS;
  throw StoreError({full ? FaultCode::kStorageFull : FaultCode::kStorageFailed, folder.filename().string(), error.message()});
}

}  // namespace

fs::path building_file(const fs::path& folder, BuildingId id) {
  return folder / (std::string(kPrefix) + std::to_string(id.value) + std::string(kSuffix));
}

DirectoryFiles list_or_make(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) {
    fs::create_directories(folder, error);
    if (error) fail(folder, error);
    fs::permissions(folder, fs::perms::owner_all, error);
    if (error) fail(folder, error);
  }
  DirectoryFiles files;
  fs::directory_iterator entry(folder, error);
  if (error) fail(folder, error);
  for (; entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (const auto id = id_in(name, kSuffix)) files.buildings.insert(*id);
    if (const auto id = id_in(name, kCorrupt)) files.corrupt.insert(*id);
  }
  for (const BuildingId id : files.buildings) files.corrupt.erase(id);
  return files;
}

void put_aside(const fs::path& folder, BuildingId id) {
  const fs::path file = building_file(folder, id);
  std::string mark = ".corrupt";
  for (int attempt = 2; fs::exists(file.string() + mark); ++attempt) mark = ".corrupt-" + std::to_string(attempt);
  std::error_code error;
  // The log first: a database found without its log after a crash in between would look whole and be old.
  if (fs::exists(file.string() + "-wal")) fs::rename(file.string() + "-wal", file.string() + mark + "-wal", error);
  if (error) fail(folder, error);
  fs::rename(file, file.string() + mark, error);
  if (error) fail(folder, error);
  fs::remove(file.string() + "-shm", error);
}

void remove_database(const fs::path& file) {
  for (const char* part : {"", "-wal", "-shm", "-journal", ".lock"}) {
    std::error_code error;
    fs::remove(file.string() + part, error);
    if (error) fail(file.parent_path(), error);
  }
}

namespace {

// Removes what `goes` says by its name.
template <typename Goes>
void remove_where(const fs::path& folder, Goes&& goes) {
  std::error_code error;
  std::vector<fs::path> doomed;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (goes(entry->path().filename().string())) doomed.push_back(entry->path());
  }
  for (const fs::path& file : doomed) {
    if (!error) fs::remove(file, error);
  }
  if (error) fail(folder, error);
}

constexpr std::string_view kPassing = "passing-";

}  // namespace

void remove_building_files(const fs::path& folder, BuildingId id) {
  const std::string name = building_file(folder, id).filename().string();
  remove_where(folder, [&](const std::string& found) {
    return found == name || found.starts_with(name + ".") || found.starts_with(name + "-");
  });
}

void remove_old_copies(const fs::path& database) {
  const std::string name = database.filename().string() + ".v";
  remove_where(database.parent_path(), [&](const std::string& found) { return found.starts_with(name); });
}

fs::path passing_file(const fs::path& folder, std::uint64_t number) {
  return folder / (std::string(kPassing) + std::to_string(number) + ".sqlite");
}

void remove_passing_files(const fs::path& folder) {
  remove_where(folder, [](const std::string& found) { return found.starts_with(kPassing); });
}

void put_in_place(const fs::path& folder, const fs::path& database, BuildingId id) {
  std::error_code error;
  fs::rename(database, building_file(folder, id), error);
  if (error) fail(folder, error);
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  error = std::error_code(errno, std::generic_category());
  if (descriptor >= 0) ::close(descriptor);
  if (!synced) fail(folder, error);
}

}  // namespace wayfuse
