#include "admin/plan/image_header.hpp"

namespace wayfuse {
namespace {

std::uint32_t big_endian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Segments follow each other until the frame header: SOF0..SOF15 but for DHT (C4), JPG (C8) and DAC (CC).
Result<ImageHeader> jpeg_header(std::string_view bytes) {
  std::size_t at = 2;
  while (at + 9 < bytes.size() && static_cast<unsigned char>(bytes[at]) == 0xff) {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (marker == 0xff) {
      ++at;  // padding
      continue;
    }
    const bool frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) return ImageHeader{"image/jpeg", big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)};
    const std::uint32_t length = big_endian(bytes, at + 2, 2);
    if (length < 2) break;
    at += 2 + length;
  }
  return Fault{FaultCode::kMalformed, "body", "a JPEG without a frame header"};
}

}  // namespace

Result<ImageHeader> image_header(std::string_view bytes) {
  Result<ImageHeader> header = Fault{FaultCode::kUnknownType, "body", "is neither PNG nor JPEG"};
  if (bytes.starts_with("\x89PNG\r\n\x1a\n") && bytes.size() >= 24 && bytes.substr(12, 4) == "IHDR") {
    header = ImageHeader{"image/png", big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)};
  } else if (bytes.starts_with("\xff\xd8\xff")) {
    header = jpeg_header(bytes);
  }
  if (header && (header->width_px == 0 || header->height_px == 0 || header->width_px > 65535 || header->height_px > 65535)) {
    return Fault{FaultCode::kOutOfRange, "body", "an image has 1..65535 pixels a side"};
  }
  return header;
}

}  // namespace wayfuse
