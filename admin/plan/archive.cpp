#include <zip.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>

#include "admin/plan/features.hpp"

namespace wayfuse {
namespace {

constexpr zip_int64_t kMostFiles = 64;
constexpr std::size_t kMostBytes = 64u << 20;

/// A zip archive over a block of memory; what is open or not yet written is let go at the end.
struct Archive {
  Archive(const void* bytes, std::size_t size, int flags) {
    zip_error_init(&error);
    source = zip_source_buffer_create(bytes, size, 0, &error);
    if (!source) return;
    zip_source_keep(source);
    zip = zip_open_from_source(source, flags, &error);
    if (!zip) zip_source_free(source);
  }
  ~Archive() {
    if (zip) zip_discard(zip);
    if (source) zip_source_free(source);
    zip_error_fini(&error);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  zip_error_t error;
  zip_source_t* source = nullptr;
  zip_t* zip = nullptr;
};
using OpenFile = std::unique_ptr<zip_file_t, decltype(&zip_fclose)>;

Fault unsound(zip_error_t* error) {
  std::string cause = std::string(zip_error_strerror(error)).substr(0, 200);
  std::ranges::replace_if(cause, [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');  // it may quote the file
  return {FaultCode::kMalformed, "archive", cause};
}

// The last part of a path: archives come with and without a folder around their files.
std::string plain_name(const char* path) {
  std::string name = path ? path : "";
  if (const auto slash = name.find_last_of('/'); slash != std::string::npos) name.erase(0, slash + 1);
  return name;
}

/// Appends a file's content to `content`; `left` = the bytes all files may still unpack to.
std::optional<Fault> read_file(zip_t* zip, zip_uint64_t index, std::size_t& left, std::string& content) {
  const OpenFile file(zip_fopen_index(zip, index, 0), zip_fclose);
  if (!file) return unsound(zip_get_error(zip));
  char piece[65536];
  for (zip_int64_t read = 0; (read = zip_fread(file.get(), piece, sizeof piece)) != 0;) {
    if (read < 0) return unsound(zip_file_get_error(file.get()));
    if (static_cast<std::size_t>(read) > left) return Fault{FaultCode::kTooLarge, "archive", "unpacks to more than 64 MiB"};
    left -= static_cast<std::size_t>(read);
    content.append(piece, static_cast<std::size_t>(read));
  }
  return std::nullopt;
}

}  // namespace

Result<std::map<std::string, std::string>> unzip(std::string_view bytes) {
  Archive archive(bytes.data(), bytes.size(), ZIP_RDONLY);
  if (!archive.zip) return unsound(&archive.error);
  std::map<std::string, std::string> files;
  std::size_t left = kMostBytes;
  const zip_int64_t entries = zip_get_num_entries(archive.zip, 0);
  for (zip_int64_t entry = 0; entry < entries; ++entry) {
    const auto index = static_cast<zip_uint64_t>(entry);
    const std::string name = plain_name(zip_get_name(archive.zip, index, ZIP_FL_ENC_GUESS));
    if (name.empty() || name.front() == '.') continue;
    if (files.size() >= kMostFiles) return Fault{FaultCode::kTooLarge, "archive", "more than 64 files"};
    const auto [file, fresh] = files.try_emplace(name);
    if (!fresh) return Fault{FaultCode::kMalformed, "archive", "a file stands twice"};
    if (const auto fault = read_file(archive.zip, index, left, file->second)) return *fault;
  }
  return files;
}

std::string zip(const std::map<std::string, std::string>& files) {
  Archive archive(nullptr, 0, ZIP_CREATE | ZIP_TRUNCATE);
  const auto must = [&](bool done) {
    if (!done) throw std::runtime_error(unsound(archive.zip ? zip_get_error(archive.zip) : &archive.error).cause);
  };
  must(archive.zip);
  for (const auto& [name, content] : files) {
    zip_source_t* const source = zip_source_buffer(archive.zip, content.data(), content.size(), 0);
    must(source);
    const zip_int64_t index = zip_file_add(archive.zip, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) zip_source_free(source);
    must(index >= 0);
    must(zip_file_set_external_attributes(archive.zip, static_cast<zip_uint64_t>(index), 0, ZIP_OPSYS_UNIX, 0100644u << 16) == 0);
  }
  must(zip_close(archive.zip) == 0);
  archive.zip = nullptr;
  must(zip_source_open(archive.source) == 0);
  std::string bytes;
  char piece[65536];
  for (zip_int64_t read = 0; (read = zip_source_read(archive.source, piece, sizeof piece)) != 0;) {
    must(read > 0);
    bytes.append(piece, static_cast<std::size_t>(read));
  }
  zip_source_close(archive.source);
  return bytes;
}

}  // namespace wayfuse
