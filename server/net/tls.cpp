#include "server/net/tls.hpp"

#include <openssl/ssl.h>

namespace wayfuse {
namespace {

// HTTP/1.1 is all that is spoken; a client that offers only others is refused by the handshake.
int choose_protocol(SSL*, const unsigned char** out, unsigned char* out_length, const unsigned char* in, unsigned int in_length,
                    void*) {
  static constexpr unsigned char kHttp11[] = "\x08http/1.1";
  unsigned char* chosen = nullptr;
  const int found = SSL_select_next_proto(&chosen, out_length, kHttp11, sizeof kHttp11 - 1, in, in_length);
  *out = chosen;
  return found == OPENSSL_NPN_NEGOTIATED ? SSL_TLSEXT_ERR_OK : SSL_TLSEXT_ERR_ALERT_FATAL;
}

}  // namespace

Result<std::shared_ptr<boost::asio::ssl::context>> tls_context(const std::string& certificate_file,
                                                               const std::string& key_file) {
  namespace ssl = boost::asio::ssl;
  auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
  SSL_CTX* native = context->native_handle();
  SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION);
  SSL_CTX_set_cipher_list(native, "ECDHE+AESGCM:ECDHE+CHACHA20");
  SSL_CTX_set_options(native, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_mode(native, SSL_MODE_RELEASE_BUFFERS);  // an idle session need not hold 34 kB of record buffers
  SSL_CTX_set_session_cache_mode(native, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_alpn_select_cb(native, choose_protocol, nullptr);
  boost::system::error_code error;
  context->use_certificate_chain_file(certificate_file, error);
  if (error) return Fault{FaultCode::kUnknownName, "tls.certificate", certificate_file + ": " + error.message()};
  context->use_private_key_file(key_file, ssl::context::pem, error);
  if (error) return Fault{FaultCode::kUnknownName, "tls.key", key_file + ": " + error.message()};
  if (SSL_CTX_check_private_key(native) != 1)
    return Fault{FaultCode::kConflict, "tls.key", "it does not belong to the certificate"};
  return context;
}

}  // namespace wayfuse
