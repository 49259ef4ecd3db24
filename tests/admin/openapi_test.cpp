#include <algorithm>
#include <set>

#include "tests/admin/running_api.hpp"

// What the server hands out as its description is linted here and held against its routes. That its answers are as described is
// seen by every test that asks RunningApi, and by described_api_test.py on a running server.
namespace wayfuse {
namespace {

using nlohmann::json;

class OpenApi : public testing::Test {
 protected:
  struct Operation {
    std::string method, path;
    const json& said;
    std::string name() const { return method + " " + path; }
  };

  const json& at(const json& node) const { return SchemaCheck(document).resolved(node); }
  std::vector<Operation> operations() const {
    std::vector<Operation> all;
    for (const auto& [path, item] : document["paths"].items()) {
      for (const auto& [method, said] : item.items()) {
        std::string upper = method;
        std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
        all.push_back({upper, path, said});
      }
    }
    return all;
  }
  std::vector<json> parameters(const Operation& operation) const {
    std::vector<json> all;
    for (const json& each : operation.said.value("parameters", json::array())) all.push_back(at(each));
    return all;
  }
  bool takes(const Operation& operation, const std::string& header) const {
    return std::ranges::any_of(parameters(operation), [&](const json& each) { return each["in"] == "header" && each["name"] == header; });
  }

  RunningApi api;
  const json document = api.ask("GET", "/v1/openapi.json", "").json();
};

const char* scope_name(Scope scope) {
  switch (scope) {
    case Scope::kPublic: return "public";
    case Scope::kTrack: return "track";
    case Scope::kSurvey: return "survey";
    case Scope::kObserve: return "observe";
    case Scope::kAdmin: return "admin";
  }
  return "?";
}

// Pages and what they load are for browsers, not for clients.
bool for_browsers(const Route& route) {
  return route.pattern == "/" || route.pattern.starts_with("/console/") || route.pattern == "/docs/docs.css";
}

TEST_F(OpenApi, DescribesEveryRouteWithItsScopeAndNoOther) {
  EXPECT_EQ(document["openapi"], "3.1.0");
  std::set<std::string> described, routed;
  for (const Operation& operation : operations()) {
    const json& security = operation.said["security"];
    described.insert(operation.name() + " " + (security.empty() ? "public" : security[0]["key"][0].get<std::string>()) + ": " +
                     operation.said["summary"].get<std::string>());
  }
  for (const Route& route : api.router->routes()) {
    if (!for_browsers(route)) routed.insert(route.method + " " + route.pattern + " " + scope_name(route.scope) + ": " + route.summary);
  }
  std::vector<std::string> missing, invented;
  std::ranges::set_difference(routed, described, std::back_inserter(missing));
  std::ranges::set_difference(described, routed, std::back_inserter(invented));
  EXPECT_EQ(missing, std::vector<std::string>()) << "routes that admin/openapi/openapi.json does not describe";
  EXPECT_EQ(invented, std::vector<std::string>()) << "described, but there are no such routes";
}

void collect_references(const json& node, std::set<std::string>& references) {
  if (node.is_object() && node.contains("$ref")) references.insert(node["$ref"].get<std::string>());
  if (node.is_structured()) {
    for (const json& child : node) collect_references(child, references);
  }
}

TEST_F(OpenApi, EveryReferenceLeadsSomewhereAndEveryComponentIsUsed) {
  std::set<std::string> references, components;
  collect_references(document, references);
  for (const char* kind : {"schemas", "responses", "parameters", "headers"}) {
    for (const auto& [name, _] : document["components"][kind].items()) components.insert(std::string("#/components/") + kind + "/" + name);
  }
  EXPECT_EQ(references, components);
}

TEST_F(OpenApi, OperationsHaveNamesOfTheirOwnAndDeclareTheirPathParameters) {
  std::set<std::string> names, tags, used;
  for (const json& tag : document["tags"]) tags.insert(tag["name"]);
  for (const Operation& operation : operations()) {
    EXPECT_TRUE(names.insert(operation.said["operationId"]).second) << operation.said["operationId"];
    ASSERT_EQ(operation.said["tags"].size(), 1u) << operation.name();
    used.insert(operation.said["tags"][0]);
    std::size_t in_path = 0;
    std::set<std::string> seen;
    for (const json& parameter : parameters(operation)) {
      EXPECT_TRUE(seen.insert(parameter["in"].get<std::string>() + " " + parameter["name"].get<std::string>()).second) << operation.name() << parameter;
      if (parameter["in"] != "path") continue;
      ++in_path;
      EXPECT_TRUE(parameter["required"].get<bool>());
      EXPECT_NE(operation.path.find("{" + parameter["name"].get<std::string>() + "}"), std::string::npos) << operation.path;
    }
    EXPECT_EQ(in_path, static_cast<std::size_t>(std::ranges::count(operation.path, '{'))) << operation.name();
  }
  EXPECT_EQ(tags, used);
}

TEST_F(OpenApi, SaysWhatEverythingIs) {
  const auto said = [](const json& node, const char* member) { return !node.value(member, "").empty(); };
  for (const Operation& operation : operations()) {
    EXPECT_TRUE(said(operation.said, "summary")) << operation.name();
    for (const json& parameter : parameters(operation)) EXPECT_TRUE(said(parameter, "description") && parameter.contains("schema")) << operation.name() << parameter;
    for (const auto& [status, response] : operation.said["responses"].items()) EXPECT_TRUE(said(at(response), "description")) << operation.name() << " " << status;
  }
  for (const auto& [name, schema] : document["components"]["schemas"].items()) {
    const bool by_field = name == "Place" || name == "Reading" || name == "ReferencePoint";  // they say it at each field
    EXPECT_TRUE(by_field || said(schema, "description")) << name;
  }
}

TEST_F(OpenApi, DescribesFaultsWhereTheyCanCome) {
  for (const Operation& operation : operations()) {
    const json& responses = operation.said["responses"];
    const bool open = operation.said["security"].empty();
    for (const char* status : {"401", "403", "429", "500", "503"}) {
      if (operation.path != "/readyz") {
        EXPECT_EQ(responses.contains(status), !open) << operation.name() << " " << status;
      }
    }
    EXPECT_EQ(responses.contains("412"), takes(operation, "If-Match")) << operation.name();
    EXPECT_EQ(responses.contains("304"), takes(operation, "If-None-Match")) << operation.name();
    EXPECT_EQ(operation.method == "POST", takes(operation, "Idempotency-Key")) << operation.name();
    if (operation.path.find('{') != std::string::npos) {
      EXPECT_TRUE(responses.contains("404")) << operation.name();
    }
    if (operation.said.contains("requestBody")) {
      EXPECT_TRUE(responses.contains("413") && responses.contains("422")) << operation.name();
    }
    EXPECT_TRUE(std::ranges::any_of(responses.items(), [](const auto& each) { return each.key()[0] == '2'; })) << operation.name();
  }
}

TEST_F(OpenApi, ShowsBodiesThatFitTheirSchemas) {
  const SchemaCheck check(document);
  std::size_t shown = 0;
  for (const Operation& operation : operations()) {
    if (!operation.said.contains("requestBody")) continue;
    for (const auto& [media_type, content] : operation.said["requestBody"]["content"].items()) {
      if (media_type.find("json") == std::string::npos || media_type == "application/x-ndjson") continue;
      ASSERT_TRUE(content.contains("example")) << operation.name() << " shows no body";
      EXPECT_EQ(check.misfit(content["example"], content["schema"]), "") << operation.name();
      ++shown;
    }
  }
  EXPECT_GT(shown, 10u);
  const json& delivery = document["webhooks"]["zone_event"]["post"]["requestBody"]["content"]["application/json"];
  EXPECT_EQ(check.misfit(delivery["example"], delivery["schema"]), "");
}

// `reference_point` -> `ReferencePoint`, and what only people read is left out.
json as_here(const json& node) {
  if (node.is_array()) {
    json list = json::array();
    for (const json& each : node) list.push_back(as_here(each));
    return list;
  }
  if (!node.is_object()) return node;
  json made = json::object();
  for (const auto& [name, value] : node.items()) {
    if (name == "$ref") {
      std::string reference, last = value.get<std::string>().substr(value.get<std::string>().rfind('/') + 1);
      bool upper = true;
      for (const char c : last) {
        if (c != '_') reference += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        upper = c == '_';
      }
      made[name] = "#/components/schemas/" + reference;
    } else if (!name.starts_with("x-")) {
      made[name] = as_here(value);
    }
  }
  return made;
}

TEST_F(OpenApi, SaysTheSameAsTheStreamingSideOfWhatBothSpeakOf) {
  const json streaming = api.ask("GET", "/v1/asyncapi.json", "").json();
  EXPECT_EQ(streaming["asyncapi"], "3.0.0");
  for (const char* name : {"survey", "reference_point", "place", "scan", "reading", "zone_event"}) {
    const json reference = as_here({{"$ref", std::string("/") + name}});
    EXPECT_EQ(at(reference), as_here(streaming["components"]["schemas"][name])) << name;
  }
}

TEST_F(OpenApi, CanBeReadAsPages) {
  const auto page = api.ask("GET", "/docs", "");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.content_type, "text/html; charset=utf-8");
  for (const auto& [path, item] : document["paths"].items()) EXPECT_NE(page.body.find("<code>" + path + "</code>"), std::string::npos) << path;
  const auto sessions = api.ask("GET", "/docs/sessions", "");
  const json streaming = api.ask("GET", "/v1/asyncapi.json", "").json();
  for (const auto& [name, _] : streaming["components"]["messages"].items()) {
    EXPECT_NE(sessions.body.find("<details id=\"" + name + "\">"), std::string::npos) << name;
  }
  for (const auto& shown : {page, sessions}) {
    EXPECT_EQ(shown.body.find("<script"), std::string::npos);
    EXPECT_EQ(shown.body.find("style="), std::string::npos);
    EXPECT_EQ(shown.body.find("src=\"http"), std::string::npos);
    EXPECT_EQ(shown.headers.at("content-security-policy").find("default-src 'none'"), 0u);
  }
}

}  // namespace
}  // namespace wayfuse
