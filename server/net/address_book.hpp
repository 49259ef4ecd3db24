#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Lets `per_second` things happen in the long run and `burst` at once.
class TokenBucket {
 public:
  TokenBucket(double per_second, double burst, ServerTime now)
      : per_second_(per_second), burst_(burst), tokens_(burst), at_(now) {}
  /// Takes what is asked; may go into debt, which must be paid before anything is let through again.
  void spend(double tokens, ServerTime now) {
    refill(now);
    tokens_ -= tokens;
  }
  bool has(ServerTime now) {
    refill(now);
    return tokens_ >= 1.0;
  }
  bool full(ServerTime now) {
    refill(now);
    return tokens_ >= burst_;
  }

 private:
  void refill(ServerTime now) {
    if (now <= at_) return;
    tokens_ = std::min(burst_, tokens_ + per_second_ * seconds(now - at_));
    at_ = now;
  }
  double per_second_;
  double burst_;
  double tokens_;
  ServerTime at_;
};

/// Who comes from where: caps and rates before anybody is authenticated [SAFETY C5, C13]. An IPv6 host is its /64.
///
/// Thread: any; one mutex.
class AddressBook : public std::enable_shared_from_this<AddressBook> {
 public:
  struct Settings {
    std::size_t connections_most = 4096;  ///< of one address at a time
    double connections_per_second = 200;  ///< of one address
    double connections_burst = 2000;
    double refusals_per_second = 1;  ///< failed authentications of one address before it has to wait
    double refusals_burst = 20;
  };
  explicit AddressBook(Settings settings) : settings_(settings) {}

  /// Counts a connection until the lease is destroyed; null = too many.
  std::shared_ptr<void> enter(const std::string& address, ServerTime now);
  /// False = that address failed too often lately to be looked at.
  bool may_authenticate(const std::string& address, ServerTime now);
  void refused(const std::string& address, ServerTime now);
  std::size_t size() const;

 private:
  struct Entry {
    std::size_t connections = 0;
    TokenBucket arrivals;
    TokenBucket refusals;
  };
  Entry& entry(const std::string& address, ServerTime now);
  void leave(const std::string& address);
  void tidy(ServerTime now);

  const Settings settings_;
  mutable std::mutex mutex_;
  std::map<std::string, Entry> entries_;
  std::size_t tidy_at_ = 1024;
};

}  // namespace wayfuse
