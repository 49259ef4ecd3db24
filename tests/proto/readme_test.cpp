#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "tests/proto/field_table.hpp"
#include "tests/proto/golden.hpp"
#include "tests/proto/readme_sections.hpp"

// proto/README.md is the contract: its tables and examples are held to the code.
namespace wayfuse {
namespace {

using nlohmann::json;
using Row = ReadmeRow;

TEST(ProtoReadme, TablesSayWhatTheCodeReads) {
  auto documented = readme_sections();
  for (const FieldTable& table : all_field_tables()) {
    const ReadmeSection& section = documented[table.title];
    ASSERT_EQ(section.rows.size(), table.rows.size()) << table.title;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const FieldRow& row = table.rows[i];
      const Row& written = section.rows[i];
      ASSERT_EQ(written.size(), 5u) << table.title << ' ' << row.name;
      EXPECT_EQ(written[0], '`' + row.name + '`') << table.title;
      EXPECT_EQ(written[1], row.type) << table.title << ' ' << row.name;
      EXPECT_EQ(written[2], row.range) << table.title << ' ' << row.name;
      EXPECT_EQ(written[3], row.needed) << table.title << ' ' << row.name;
      EXPECT_FALSE(written[4].empty()) << table.title << ' ' << row.name << " has no meaning";
    }
  }
}

TEST(ProtoReadme, ListsEveryFaultWithItsFaces) {
  const std::vector<Row> rows = readme_sections()["Faults"].rows;
  ASSERT_EQ(rows.size(), fault_table().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const FaultFace& face = fault_table()[i];
    const std::string close = face.close_code == 0 ? "-" : std::to_string(face.close_code);
    EXPECT_EQ(rows[i], (Row{std::to_string(static_cast<int>(face.code)), '`' + std::string(face.name) + '`',
                            std::to_string(face.http_status), close, std::string(face.summary)}));
  }
}

TEST(ProtoReadme, ShowsEveryMessageAsItsGoldenDocument) {
  auto documented = readme_sections();
  std::size_t shown = 0;
  for (const Golden& golden : golden_documents()) {
    const std::string type = json::parse(golden.text).at("type");
    ASSERT_FALSE(documented[type].blocks.empty()) << type << " has no example";
    if (type != golden.name) continue;  // a second document of the same message
    EXPECT_EQ(json::parse(documented[type].blocks[0]), json::parse(golden.text)) << type;
    ++shown;
  }
  EXPECT_EQ(shown, std::variant_size_v<ClientMessage> + std::variant_size_v<ServerMessage>);
}

TEST(ProtoReadme, EveryExampleIsAMessage) {
  for (const auto& [title, section] : readme_sections()) {
    for (const std::string& block : section.blocks) {
      const auto from_client = decode_client_message(block, Encoding::kJson);
      const auto from_server = decode_server_message(block, Encoding::kJson);
      EXPECT_TRUE(from_client || from_server) << title << '\n' << block << to_string(from_client.fault());
    }
  }
}

// Members of an aggregate, by trying how many initialisers it takes: a member without a field would be lost on the wire.
struct Anything {
  template <typename T>
  operator T() const {
    return T{};
  }  // never called: only its type is looked at
};
template <typename T, typename... Given>
constexpr std::size_t members_of() {
  if constexpr (requires { T{Given{}..., Anything{}}; }) {
    return members_of<T, Given..., Anything>();
  } else {
    return sizeof...(Given);
  }
}

TEST(FieldTables, LeaveNoMemberOut) {
  std::map<std::string, std::size_t> fields;
  for (const FieldTable& table : all_field_tables()) fields[table.title] = table.rows.size();
  const auto expect = [&]<typename T>(const T*) {
    EXPECT_EQ(fields.at(std::string(kPartName<T>)), members_of<T>()) << kPartName<T>;
  };
  const auto expect_all = [&]<typename... T>(const std::variant<T...>*) {
    ((std::is_same_v<T, SampleBatch> ? void() : expect(static_cast<const T*>(nullptr))), ...);
  };
  expect_all(static_cast<const ClientMessage*>(nullptr));
  expect_all(static_cast<const ServerMessage*>(nullptr));
  expect_all(static_cast<const SampleBody*>(nullptr));
  expect_all(
      static_cast<const std::variant<GeoPoint, Georeference, MagneticField, ScanReading, ReferencePoint, Covariance,
                                     FloorProbability, Contributions, FusedPosition, Resume, WayPoint, FloorName, Observed>*>(
          nullptr));
  EXPECT_EQ(fields.at("place"), 3u);                        // the point's two and the floor
  EXPECT_EQ(fields.at("samples"), 2u);                      // first_sequence besides
  EXPECT_EQ(fields.at("reason"), members_of<Fault>() + 1);  // the name besides
}

}  // namespace
}  // namespace wayfuse
