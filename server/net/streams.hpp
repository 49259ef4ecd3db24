#pragma once

#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/strand.hpp>
#include <memory>
#include <string>

namespace wayfuse {

namespace asio = boost::asio;

/// One strand a connection, with a concrete executor: type erasure and a timer in every stream cost a third of an echo.
using Strand = asio::strand<asio::io_context::executor_type>;
using PlainStream = asio::basic_stream_socket<asio::ip::tcp, Strand>;
using TlsStream = asio::ssl::stream<PlainStream>;

inline PlainStream& lowest(PlainStream& stream) {
  return stream;
}
inline PlainStream& lowest(TlsStream& stream) {
  return stream.next_layer();
}

/// What a connection holds until it ends, apart from its stream.
struct Visit {
  std::string address;                      ///< for rates; never logged
  std::shared_ptr<void> lease;              ///< in the address book and the counts
  std::shared_ptr<asio::ssl::context> tls;  ///< kept alive by those that use it
};

}  // namespace wayfuse
