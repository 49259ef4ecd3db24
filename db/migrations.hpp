#pragma once

#include <span>
#include <string_view>

namespace wayfuse {

/// The files of db/migrations, embedded at build time, in order.
std::span<const std::string_view> building_migrations();
std::span<const std::string_view> server_migrations();

}  // namespace wayfuse
