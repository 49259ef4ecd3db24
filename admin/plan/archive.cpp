#include <archive.h>
#include <archive_entry.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "admin/plan/features.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kMostFiles = 64;
constexpr std::size_t kMostBytes = 64u << 20;

using Reading = std::unique_ptr<archive, decltype(&archive_read_free)>;
using Writing = std::unique_ptr<archive, decltype(&archive_write_free)>;

Fault unsound(archive* zip) {
  const char* said = archive_error_string(zip);
  std::string cause = said ? std::string(said).substr(0, 200) : "is no zip archive";
  std::ranges::replace_if(cause, [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');  // it may quote the file
  return {FaultCode::kMalformed, "archive", cause};
}

// The last part of a path: archives come with and without a folder around their files.
std::string plain_name(const char* path) {
  std::string name = path ? path : "";
  if (const auto slash = name.find_last_of('/'); slash != std::string::npos) name.erase(0, slash + 1);
  return name;
}

la_ssize_t append(archive*, void* into, const void* data, std::size_t size) {
  static_cast<std::string*>(into)->append(static_cast<const char*>(data), size);
  return static_cast<la_ssize_t>(size);
}

}  // namespace

Result<std::map<std::string, std::string>> unzip(std::string_view bytes) {
  const Reading zip(archive_read_new(), archive_read_free);
  archive_read_support_format_zip(zip.get());
  if (archive_read_open_memory(zip.get(), bytes.data(), bytes.size()) != ARCHIVE_OK) return unsound(zip.get());
  std::map<std::string, std::string> files;
  std::size_t total = 0;
  for (archive_entry* entry = nullptr;;) {
    const int state = archive_read_next_header(zip.get(), &entry);
    if (state == ARCHIVE_EOF) return files;
    if (state != ARCHIVE_OK && state != ARCHIVE_WARN) return unsound(zip.get());
    const std::string name = plain_name(archive_entry_pathname(entry));
    if (archive_entry_filetype(entry) != AE_IFREG || name.empty() || name.front() == '.') continue;
    if (files.size() >= kMostFiles) return Fault{FaultCode::kTooLarge, "archive", "more than 64 files"};
    if (files.contains(name)) return Fault{FaultCode::kMalformed, "archive", "a file stands twice"};
    std::string& content = files[name];
    char piece[65536];
    for (la_ssize_t read = 0; (read = archive_read_data(zip.get(), piece, sizeof piece)) != 0;) {
      if (read < 0) return unsound(zip.get());
      total += static_cast<std::size_t>(read);
      if (total > kMostBytes) return Fault{FaultCode::kTooLarge, "archive", "unpacks to more than 64 MiB"};
      content.append(piece, static_cast<std::size_t>(read));
    }
  }
}

std::string zip(const std::map<std::string, std::string>& files) {
  std::string bytes;
  const Writing zip(archive_write_new(), archive_write_free);
  archive_write_set_format_zip(zip.get());
  archive_write_set_bytes_in_last_block(zip.get(), 1);
  const auto must = [&](int state) {
    if (state != ARCHIVE_OK) throw std::runtime_error(unsound(zip.get()).cause);
  };
  must(archive_write_open(zip.get(), &bytes, nullptr, append, nullptr));
  for (const auto& [name, content] : files) {
    const std::unique_ptr<archive_entry, decltype(&archive_entry_free)> entry(archive_entry_new(), archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    must(archive_write_header(zip.get(), entry.get()));
    if (archive_write_data(zip.get(), content.data(), content.size()) != static_cast<la_ssize_t>(content.size())) must(ARCHIVE_FATAL);
  }
  must(archive_write_close(zip.get()));
  return bytes;
}

}  // namespace wayfuse
