#include <gtest/gtest.h>

#include "admin/cli/explanation.hpp"
#include "admin/cli/sessions_top.hpp"
#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

TEST(Table, AlignsColumnsByCharactersNotBytes) {
  EXPECT_EQ(table({"id", "name", "x"}, {{"1", "Höf", "a"}, {"22", "Annex", "b"}}),
            "id  name   x\n"
            "1   Höf    a\n"
            "22  Annex  b\n");
}

TEST(Table, ShowsAListAsRowsAndTheRestAsJson) {
  EXPECT_EQ(readable(R"({"keys":[{"id":1,"scopes":["track","survey"]}]})", "keys", {"id", "scopes", "name"}),
            "id  scopes        name\n"
            "1   track,survey  -\n");
  EXPECT_EQ(readable(R"({"ready":true})", "", {}), "{\n  \"ready\": true\n}\n");
  EXPECT_EQ(readable("not json", "", {}), "not json\n");
}

TEST(SessionsTop, ShowsTheLeastCertainFirstAndHowFastTheySpeak) {
  const std::string before = R"({"sessions":[{"tracked":"phone-b","applied_through":10},{"tracked":"phone-a","applied_through":90}]})";
  const std::string now = R"({"sessions":[
      {"tracked":"phone-a","building":1,"device_model":"M","pipeline":"p1","connected":true,"applied_through":100,
       "position":{"x_m":1,"y_m":2.26,"floor":0,"radius68_m":2.5,"integrity":"ok"}},
      {"tracked":"phone-c","building":2,"device_model":"M","pipeline":"nn","connected":false,"applied_through":7},
      {"tracked":"phone-b","building":1,"device_model":"M","pipeline":"p1","connected":true,"applied_through":5,
       "position":{"x_m":3,"y_m":4,"floor":-1,"radius68_m":9,"integrity":"suspect"}}]})";
  EXPECT_EQ(top_of(now, before, 4.0, 2),
            "3 sessions, 2 connected, 2 placed\n"
            "tracked  building  floor  x, y m    within m  integrity  samples/s  connected  pipeline  device\n"
            "phone-b  1         -1     3.0, 4.0  9.0       suspect    -          yes        p1        M\n"
            "phone-a  1         0      1.0, 2.3  2.5       ok         2.5        yes        p1        M\n"
            "and 1 more\n");
  EXPECT_EQ(top_of(R"({"sessions":[]})", "", 0, 9).substr(0, 10), "0 sessions");
}

TEST(Explained, SaysWhereThenHoldsEachReadingAgainstTheSurvey) {
  EXPECT_EQ(explained(R"({"tracked":"phone-x","building":1,"pipeline":"p1",
      "position":{"x_m":12.34,"y_m":-5,"floor":2,"radius68_m":1.5,"radius95_m":3.75,"radio_map_version":7},
      "scan_age_us":1500000,"steps_since_scan":3,"gnss":false,"surveyed_points_near":8,
      "used":[{"bssid":"00:00:00:00:00:01","heard_dbm":-61,"expected_dbm":-55,"residual_db":-6,"surveyed_scans":24,"age_us":300000}],
      "rejected":[{"bssid":"00:00:00:00:00:02","heard_dbm":-70,"expected_dbm":null,"residual_db":null,"surveyed_scans":0,"age_us":0,
                   "why":"not on the map"}],
      "floor_votes":[{"floor":2,"probability":0.75},{"floor":1,"probability":0.25}],
      "integrity":{"state":"degraded","reasons":["it rains"]},"particles":[]})"),
            "phone-x in building 1 by p1, radio map 7\n"
            "at x 12.3 m, y -5.0 m, floor 2; 68 % within 1.5 m, 95 % within 3.8 m\n"
            "newest scan 1.5 s ago, 3 steps since\n"
            "floors: 2 (75 %) 1 (25 %)\n"
            "integrity: degraded\n"
            "  it rains\n"
            "1 readings used, 1 rejected; expected levels from 8 surveyed points nearby\n\n"
            "access point       heard dBm  expected  residual dB  age s  use\n"
            "00:00:00:00:00:01  -61        -55       -6.0         0.3    used\n"
            "00:00:00:00:00:02  -70        -         -            0.0    not on the map\n");
}

}  // namespace
}  // namespace wayfuse::cli
