#pragma once

#include <span>
#include <string_view>

namespace wayfuse {

/// A file of presets/, embedded when the program was built.
struct PresetFile {
  std::string_view name;
  std::string_view json;
};

std::span<const PresetFile> preset_files();

}  // namespace wayfuse
