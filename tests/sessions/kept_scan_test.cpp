#include "server/sessions/kept_scan.hpp"

#include <gtest/gtest.h>

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

TEST(KeptScan, ComesBackBitForBit) {
  RssScan scan{PhoneTime{12500ms}, {{Bssid{0xffffffffffff}, -61, 1'234'567us, 5180, {}, {}},
                          {Bssid{1}, -0.5, Duration{0}, 0, {}, {}},
                          {Bssid{2}, -120, 10min, 65535, {}, {}}}};
  const KeptScan packed(scan);
  EXPECT_EQ(packed.scan(), scan);
  EXPECT_EQ(packed.readings(), 3u);
  EXPECT_LE(packed.bytes(), 3 * sizeof(ScanReading) / 4);

  for (const ScanReading& odd : {ScanReading{Bssid{3}, -61.3, Duration{0}, 2412, {}, {}}, ScanReading{Bssid{3}, -61, Duration{0}, 2412, 4.5, 0.5},
                                 ScanReading{Bssid{3}, -61, Duration{-1}, 2412, {}, {}}, ScanReading{Bssid{1ull << 48}, -61, Duration{0}, 2412, {}, {}}}) {
    RssScan with = scan;
    with.readings.push_back(odd);
    EXPECT_EQ(KeptScan(with).scan(), with) << odd.rss_dbm;
    EXPECT_EQ(KeptScan(with).readings(), 4u);
  }
  EXPECT_EQ(KeptScan(RssScan{PhoneTime{1s}, {}}).scan(), (RssScan{PhoneTime{1s}, {}}));
}

}  // namespace
}  // namespace wayfuse
