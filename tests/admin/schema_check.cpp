#include "tests/admin/schema_check.hpp"

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
#include <sstream>

namespace wayfuse {
namespace {

using nlohmann::json;

bool is_of(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "integer") return value.is_number_integer();
  return type == "number" && value.is_number();
}

bool fits(const std::string& pattern, const std::string& path) {
  std::istringstream wanted(pattern), given(path);
  std::string a, b;
  while (std::getline(wanted, a, '/')) {
    if (!std::getline(given, b, '/') || (a != b && (a.empty() || a.front() != '{'))) return false;
  }
  return !std::getline(given, b, '/');
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string header_misfit(const json& response, const ApiDescription::Answer& answer) {
  const json described = response.value("headers", json::object());
  for (const auto& [name, _] : described.items()) {
    if (std::ranges::none_of(answer.headers, [&](const auto& header) { return lower(header.first) == lower(name); })) return "header " + name + " is missing";
  }
  return "";
}

}  // namespace

const json& SchemaCheck::resolved(const json& node) const {
  if (!node.contains("$ref")) return node;
  return document_.at(json::json_pointer(node["$ref"].get<std::string>().substr(1)));
}

std::string SchemaCheck::kind_misfit(const json& value, const json& type, const std::string& at) const {
  const bool fits = type.is_array() ? std::ranges::any_of(type, [&](const json& each) { return is_of(value, each); }) : is_of(value, type);
  return fits ? "" : at + ": " + value.dump().substr(0, 80) + " is no " + type.dump();
}

std::string SchemaCheck::object_misfit(const json& value, const json& schema, const std::string& at) const {
  for (const json& name : schema.value("required", json::array())) {
    if (!value.contains(name.get<std::string>())) return at + ": " + name.dump() + " is missing";
  }
  for (const auto& [name, member] : value.items()) {
    const bool known = schema.contains("properties") && schema["properties"].contains(name);
    if (!known && schema.contains("properties") && !schema.contains("additionalProperties")) return at + ": " + name + " is not described";
    if (!known && !schema.contains("additionalProperties")) continue;
    const auto misfit_here = misfit(member, known ? schema["properties"][name] : schema["additionalProperties"], at + "/" + name);
    if (!misfit_here.empty()) return misfit_here;
  }
  return "";
}

std::string SchemaCheck::misfit(const json& value, const json& unresolved, const std::string& at) const {
  const json& schema = resolved(unresolved);
  static const std::set<std::string> known = {"$ref", "type", "properties", "required", "additionalProperties", "items", "enum", "const", "oneOf",
                                              "description", "default", "examples", "minimum", "maximum", "minLength", "maxLength", "minItems",
                                              "maxItems", "pattern", "contentEncoding"};
  for (const auto& [keyword, _] : schema.items()) {
    if (!known.contains(keyword)) return at + ": the schema says '" + keyword + "', which is not checked";
  }
  if (schema.contains("oneOf")) {
    std::string reasons;
    for (const json& each : schema["oneOf"]) {
      const std::string reason = misfit(value, each, at);
      if (reason.empty()) return "";
      reasons += "; " + reason;
    }
    return at + ": fits none" + reasons;
  }
  if (schema.contains("type")) {
    if (const auto reason = kind_misfit(value, schema["type"], at); !reason.empty()) return reason;
  }
  if (schema.contains("const") && value != schema["const"]) return at + ": is not " + schema["const"].dump();
  if (schema.contains("enum") && std::ranges::find(schema["enum"], value) == schema["enum"].end()) return at + ": " + value.dump() + " is none of " + schema["enum"].dump();
  if (value.is_number() && ((schema.contains("minimum") && value < schema["minimum"]) || (schema.contains("maximum") && value > schema["maximum"]))) {
    return at + ": " + value.dump() + " is out of range";
  }
  if (value.is_string() && schema.contains("pattern") && !std::regex_search(value.get<std::string>(), std::regex(schema["pattern"].get<std::string>()))) {
    return at + ": " + value.dump() + " is not of the pattern";
  }
  if (value.is_string() && (value.get<std::string>().size() < schema.value("minLength", std::size_t{0}) || value.get<std::string>().size() > schema.value("maxLength", SIZE_MAX))) {
    return at + ": its length is out of range";
  }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", std::size_t{0}) || value.size() > schema.value("maxItems", SIZE_MAX)) return at + ": its length is out of range";
    for (std::size_t i = 0; schema.contains("items") && i < value.size(); ++i) {
      if (const auto reason = misfit(value[i], schema["items"], at + "/" + std::to_string(i)); !reason.empty()) return reason;
    }
  }
  return value.is_object() ? object_misfit(value, schema, at) : "";
}

const json* ApiDescription::operation(const std::string& method, const std::string& path) const {
  // Literal paths before those with parameters, as the router has it.
  const json* found = nullptr;
  for (const auto& [pattern, item] : document_["paths"].items()) {
    if (!fits(pattern, path) || !item.contains(lower(method))) continue;
    if (!found || pattern == path) found = &item[lower(method)];
  }
  return found;
}

std::string ApiDescription::misfit(const std::string& method, const std::string& path, const Answer& answer) const {
  const json* described = operation(method, path);
  if (!described) return "";
  const SchemaCheck check(document_);
  const std::string status = std::to_string(answer.status);
  if (!(*described)["responses"].contains(status)) return "status " + status + " is not described: " + answer.body.substr(0, 300);
  const json& response = check.resolved((*described)["responses"][status]);
  if (const std::string reason = header_misfit(response, answer); !reason.empty()) return status + ": " + reason;
  if (!response.contains("content")) return answer.body.empty() ? "" : status + " is described without a body";
  const std::string media_type = answer.content_type.substr(0, answer.content_type.find(';'));
  if (!response["content"].contains(media_type)) return status + ": " + media_type + " is not described";
  const json& schema = response["content"][media_type]["schema"];
  if (media_type.find("json") == std::string::npos || media_type == "application/x-ndjson") return "";
  const json body = json::parse(answer.body, nullptr, false);
  return body.is_discarded() ? status + ": the body is no JSON" : check.misfit(body, schema, status + " " + media_type);
}

}  // namespace wayfuse
