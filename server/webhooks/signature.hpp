#pragma once

#include <string>
#include <string_view>

namespace wayfuse {

/// `v1,<base64>` of HMAC-SHA256 over `id.timestamp.body`, as in the Standard Webhooks specification, so that its libraries
/// verify our events as they are.
std::string webhook_signature(std::string_view secret, std::string_view id, std::string_view timestamp, std::string_view body);

}  // namespace wayfuse
