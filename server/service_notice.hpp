#pragma once

#include <string_view>

namespace wayfuse {

/// Tells the service manager that started us (systemd's sd_notify protocol: a datagram to $NOTIFY_SOCKET) how it stands:
/// `READY=1`, `RELOADING=1`, `STOPPING=1`. Does nothing where nobody listens.
void tell_service_manager(std::string_view state);

}  // namespace wayfuse
