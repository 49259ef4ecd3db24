// Asio and Beast compiled once, for the SDK's link and the server's net alike (target wayfuse_beast).
#include <boost/asio/impl/src.hpp>
#include <boost/asio/ssl/impl/src.hpp>
#include <boost/beast/src.hpp>
