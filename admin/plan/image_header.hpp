#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// What a picture's first bytes say.
struct ImageHeader {
  std::string media_type;      ///< `image/png` or `image/jpeg`
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
};

/// Of a PNG (ISO 15948) or a JPEG (ITU T.81); kUnknownType for anything else.
Result<ImageHeader> image_header(std::string_view bytes);

}  // namespace wayfuse
