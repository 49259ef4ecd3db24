#include "server/webhooks/target_guard.hpp"

#include <gtest/gtest.h>

namespace wayfuse {
namespace {

TEST(TargetGuard, KnowsWhatIsNotPublic) {
  for (const char* inside : {"127.0.0.1", "127.8.8.8", "10.0.0.1", "172.16.0.1", "172.31.255.255", "192.168.1.1", "169.254.169.254",
                             "100.64.0.1", "0.0.0.0", "224.0.0.1", "255.255.255.255", "198.18.0.1", "192.0.2.1", "::1", "::", "fe80::1",
                             "fc00::1", "fd12:3456::1", "ff02::1", "::ffff:127.0.0.1", "::ffff:10.0.0.1", "::127.0.0.1", "64:ff9b::10.0.0.1",
                             "2002:7f00:1::", "2001:db8::1", "2001::1", "localhost", "", "1.2.3"}) {
    EXPECT_FALSE(is_public_address(inside)) << inside;
  }
  for (const char* outside : {"8.8.8.8", "172.32.0.1", "172.15.0.1", "192.167.1.1", "100.128.0.1", "126.255.255.255", "128.0.0.1", "223.255.255.255",
                              "2606:4700::1111", "2a00:1450::1", "::ffff:8.8.8.8", "64:ff9b::8.8.8.8"}) {
    EXPECT_TRUE(is_public_address(outside)) << outside;
  }
}

TEST(TargetGuard, TakesHttpsUrlsOnly) {
  for (const char* good : {"https://example.org/hook", "https://example.org:8443/a?b=c", "https://8.8.8.8/", "https://[2606:4700::1111]/x"}) {
    EXPECT_TRUE(check_webhook_url(good, false)) << good;
  }
  for (const char* bad : {"", "example.org", "http://example.org/", "ftp://example.org/", "file:///etc/passwd", "https://", "https://user:pw@example.org/",
                          "https://user@example.org/", "https://localhost/", "https://127.0.0.1/", "https://[::1]/", "https://169.254.169.254/latest",
                          "https://2130706433/", "https://0x7f.1/", "gopher://example.org/"}) {
    const auto checked = check_webhook_url(bad, false);
    EXPECT_FALSE(checked) << bad;
    if (!checked) EXPECT_EQ(checked.fault().field, "url");
  }
  EXPECT_FALSE(check_webhook_url("https://example.org/" + std::string(2100, 'a'), true));
  EXPECT_TRUE(check_webhook_url("http://127.0.0.1:8080/hook", true)) << "where the operator says so";
  EXPECT_FALSE(check_webhook_url("file:///etc/passwd", true));
}

}  // namespace
}  // namespace wayfuse
