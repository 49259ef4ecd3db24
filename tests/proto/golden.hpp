#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {

/// A document of proto/examples.
struct Golden {
  std::string name;  ///< file name without `.json`
  std::string text;
  bool from_client = false;
};

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// All of them, by name.
inline std::vector<Golden> golden_documents() {
  std::vector<Golden> documents;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(WAYFUSE_SOURCE_DIR) / "proto/examples")) {
    Golden golden{entry.path().stem().string(), contents(entry.path()), false};
    golden.from_client = decode_client_message(golden.text, Encoding::kJson).has_value();
    documents.push_back(std::move(golden));
  }
  std::ranges::sort(documents, {}, &Golden::name);
  return documents;
}

/// Decodes as its side would: the fault, if any. Touches what came out, so that a sanitizer sees it.
inline Result<std::string> round_trip(const std::string& frame, Encoding in, Encoding out, bool from_client) {
  if (from_client) {
    const auto message = decode_client_message(frame, in);
    if (!message) return message.fault();
    return encode(*message, out);
  }
  const auto message = decode_server_message(frame, in);
  if (!message) return message.fault();
  return encode(*message, out);
}

}  // namespace wayfuse
