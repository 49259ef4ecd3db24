#include <algorithm>
#include <nlohmann/json.hpp>

#include "admin/json_forms.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kScopes[] = {"survey", "track", "observe", "admin"};

Json to_json(const PartDescription& part) {
  Json settings = Json::array();
  for (const SettingDescription& setting : part.settings) {
    settings.push_back({{"name", setting.name},
                        {"default", setting.standard},
                        {"least", setting.least},
                        {"most", setting.most},
                        {"meaning", setting.meaning},
                        {"source", setting.source}});
  }
  return {{"role", part.role}, {"name", part.name}, {"summary", part.summary}, {"settings", std::move(settings)}};
}

Json to_form(const KeyRecord& key) {
  Json json{{"id", key.id},
            {"name", key.name},
            {"scopes", key.scopes},
            {"building", key.building.value},
            {"created_at_us", key.created_at.time_since_epoch().count()},
            {"revoked", key.revoked},
            {"coarse", key.coarse}};
  if (key.expires_at) json["expires_at_us"] = key.expires_at->time_since_epoch().count();
  return json;
}

Fault wrong(const char* field, const char* cause) { return {FaultCode::kWrongType, field, cause}; }

Result<std::vector<std::string>> scopes_of(const Json& json) {
  if (!json.is_array() || json.empty()) return wrong("scopes", "must be a list of at least one scope");
  std::vector<std::string> scopes;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string path = "scopes[" + std::to_string(i) + "]";
    if (!json[i].is_string()) return wrong(path.c_str(), "must be a text");
    auto scope = json[i].get<std::string>();
    if (std::ranges::count(kScopes, scope) == 0) {
      return Fault{FaultCode::kUnknownName, path, "'" + scope + "' is none of survey, track, observe, admin"};
    }
    scopes.push_back(std::move(scope));
  }
  return scopes;
}

}  // namespace

std::string to_json(const std::vector<PartDescription>& parts) {
  Json entries = Json::array();
  for (const PartDescription& part : parts) entries.push_back(to_json(part));
  return Json{{"parts", std::move(entries)}}.dump();
}

std::string to_json(const Readiness& readiness) {
  return Json{{"ready", readiness.ready}, {"reasons", readiness.reasons}}.dump();
}

std::string names_to_json(std::string_view field, const std::vector<std::string>& names) {
  Json json;
  json[std::string(field)] = names;
  return json.dump();
}

Result<KeyRecord> parse_key(std::string_view text, UnixTime now) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return Fault{FaultCode::kMalformed, "", "the body is not JSON"};
  if (!json.is_object()) return wrong("", "the body must be a JSON object");
  KeyRecord key;
  key.created_at = now;
  if (!json.contains("name") || !json["name"].is_string()) return Fault{FaultCode::kMissingField, "name", "is required, a text"};
  key.name = json["name"].get<std::string>();
  if (key.name.empty() || key.name.size() > 128) return Fault{FaultCode::kOutOfRange, "name", "must have 1..128 bytes"};
  if (std::ranges::any_of(key.name, [](unsigned char c) { return c < 0x20 || c == 0x7f; })) {
    return Fault{FaultCode::kBadText, "name", "holds control characters"};
  }
  if (!json.contains("scopes")) return Fault{FaultCode::kMissingField, "scopes", "is required"};
  auto scopes = scopes_of(json["scopes"]);
  if (!scopes) return scopes.fault();
  key.scopes = std::move(*scopes);
  if (json.contains("building")) {
    if (!json["building"].is_number_unsigned()) return wrong("building", "must be a building's id, or 0 for all");
    key.building = {json["building"].get<std::uint64_t>()};
  }
  if (json.contains("expires_in_s")) {
    if (!json["expires_in_s"].is_number()) return wrong("expires_in_s", "must be a number");
    const double in_s = json["expires_in_s"].get<double>();
    if (!(in_s >= 1 && in_s <= 10 * 366 * 86400.0)) {
      return Fault{FaultCode::kOutOfRange, "expires_in_s", json["expires_in_s"].dump() + " is outside 1..316224000"};
    }
    key.expires_at = now + from_seconds(in_s);
  }
  if (json.contains("coarse")) {
    if (!json["coarse"].is_boolean()) return wrong("coarse", "must be true or false");
    key.coarse = json["coarse"].get<bool>();
    if (key.coarse && std::ranges::count(key.scopes, "admin") > 0) {
      return Fault{FaultCode::kConflict, "coarse", "a key of scope admin reads everything; it cannot see zones only"};
    }
  }
  return key;
}

std::string to_json(const KeyRecord& key, std::string_view secret) {
  Json json = to_form(key);
  json["key"] = secret;
  return json.dump();
}

std::string to_json(const std::vector<KeyRecord>& keys, std::uint64_t next) {
  Json entries = Json::array();
  for (const KeyRecord& key : keys) entries.push_back(to_form(key));
  Json json{{"keys", std::move(entries)}};
  if (next != 0) json["next"] = next;
  return json.dump();
}

}  // namespace wayfuse
