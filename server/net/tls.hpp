#pragma once

#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <string>

#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// TLS 1.2 and up, AEAD suites only, server side [SAFETY C3]. Faults name the file that does not serve.
Result<std::shared_ptr<boost::asio::ssl::context>> tls_context(const std::string& certificate_file,
                                                               const std::string& key_file);

}  // namespace wayfuse
