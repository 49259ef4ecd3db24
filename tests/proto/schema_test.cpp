#include "tests/proto/schema.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "tests/proto/hostile_table.hpp"

// proto/asyncapi.json is generated from the field tables and the words of the README; the codec and the published schema must
// say the same of every document.
namespace wayfuse {
namespace {

using nlohmann::json;

const json& published() {
  static const json document = json::parse(contents(std::filesystem::path(WAYFUSE_SOURCE_DIR) / "proto/asyncapi.json"));
  return document;
}

bool valid(const json& schema, const json& value);

bool has_type(const std::string& type, const json& value) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number() && std::floor(value.get<double>()) == value.get<double>();
  return value.is_number();
}

bool valid_map(const json& schema, const json& map) {
  for (const json& name : schema.value("required", json::array())) {
    if (!map.contains(name)) return false;
  }
  const json properties = schema.value("properties", json::object());
  for (const auto& [name, inner] : properties.items()) {
    if (map.contains(name) && !valid(inner, map[name])) return false;
  }
  return true;
}

bool valid_list(const json& schema, const json& list) {
  if (list.size() < schema.value("minItems", std::size_t{0}) || list.size() > schema.value("maxItems", list.size()))
    return false;
  return std::ranges::all_of(list, [&](const json& element) { return valid(schema.at("items"), element); });
}

bool valid_text(const json& schema, const std::string& text) {
  if (text.size() < schema.value("minLength", std::size_t{0}) || text.size() > schema.value("maxLength", text.size()))
    return false;
  return !schema.contains("pattern") || std::regex_search(text, std::regex(schema["pattern"].get<std::string>()));
}

// As much of JSON Schema as the document uses.
bool valid(const json& schema, const json& value) {
  if (schema.contains("$ref")) {
    return valid(published().at(json::json_pointer(schema["$ref"].get<std::string>().substr(1))), value);
  }
  if (schema.contains("const") && schema["const"] != value) return false;
  if (schema.contains("type") && !has_type(schema["type"], value)) return false;
  if (schema.contains("enum") && !std::ranges::count(schema["enum"], value)) return false;
  if (schema.contains("minimum") && value < schema["minimum"]) return false;
  if (schema.contains("maximum") && value > schema["maximum"]) return false;
  for (const json& part : schema.value("allOf", json::array())) {
    if (!valid(part, value)) return false;
  }
  if (schema.contains("oneOf") &&
      std::ranges::count_if(schema["oneOf"], [&](const json& part) { return valid(part, value); }) != 1) {
    return false;
  }
  if (value.is_object()) return valid_map(schema, value);
  if (value.is_array()) return !schema.contains("items") || valid_list(schema, value);
  if (value.is_string()) return valid_text(schema, value.get<std::string>());
  return true;
}

bool valid_message(const json& document) {
  return document.is_object() && document.contains("type") && document["type"].is_string() &&
         published().at("components").at("messages").contains(document["type"]) &&
         valid(published().at("components").at("schemas").at(document["type"]), document);
}

TEST(AsyncApi, IsWhatTheTablesSay) {
  const OrderedJson generated = asyncapi_document();
  const std::filesystem::path fresh = std::filesystem::path(WAYFUSE_BINARY_DIR) / "asyncapi.json";
  std::ofstream(fresh) << generated.dump(1) << '\n';
  EXPECT_TRUE(published() == json(generated)) << "proto/asyncapi.json is out of date: copy " << fresh << " there";
}

TEST(AsyncApi, TakesEveryGoldenDocument) {
  for (const Golden& golden : golden_documents()) EXPECT_TRUE(valid_message(json::parse(golden.text))) << golden.name;
}

// Texts are left out: a schema counts characters, the protocol bytes, and control characters are not its concern.
TEST(AsyncApi, RefusesWhatTheCodecRefuses) {
  std::size_t compared = 0;
  for (const HostileCase& row : hostile_cases("hostile_fields.txt", false)) {
    if (row.expected == "bad_text" || row.expected == "too_large") continue;
    json document = json::parse(row.frame, nullptr, false);
    if (document.is_discarded()) continue;
    if (row.frame.find("null") != std::string::npos) continue;  // absent, for us
    EXPECT_EQ(valid_message(document), row.expected == "ok") << row.where << ' ' << row.frame.substr(0, 300);
    ++compared;
  }
  EXPECT_GT(compared, 1000u);
}

}  // namespace
}  // namespace wayfuse
