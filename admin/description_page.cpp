#include "admin/description_page.hpp"

#include <nlohmann/json.hpp>

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMethods[] = {"get", "post", "put", "delete"};

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&': html += "&amp;"; break;
      case '<': html += "&lt;"; break;
      case '>': html += "&gt;"; break;
      case '"': html += "&quot;"; break;
      default: html += c;
    }
  }
  return html;
}

// `code` between backquotes, as the descriptions have it.
std::string prose(std::string_view text) {
  std::string html;
  bool code = false;
  for (const char c : text) {
    if (c != '`') {
      html += escaped({&c, 1});
      continue;
    }
    html += code ? "</code>" : "<code>";
    code = !code;
  }
  return html + (code ? "</code>" : "");
}

std::string text_of(const Json& json, const char* name) { return json.contains(name) ? json[name].get<std::string>() : std::string(); }

std::string last_part(const std::string& reference) { return reference.substr(reference.rfind('/') + 1); }

const Json& resolved(const Json& document, const Json& node) {
  if (!node.contains("$ref")) return node;
  return document.at(Json::json_pointer(node["$ref"].get<std::string>().substr(1)));
}

std::string schema_link(const std::string& name) { return "<a href=\"#schema-" + name + "\">" + name + "</a>"; }

std::string range_of(const Json& schema) {
  if (!schema.contains("minimum") && !schema.contains("maximum")) return "";
  return " in " + (schema.contains("minimum") ? schema["minimum"].dump() : "") + ".." + (schema.contains("maximum") ? schema["maximum"].dump() : "");
}

/// A schema in a few words: its name, a list of another, the kinds it may be.
std::string kind_of(const Json& schema) {
  const auto joined = [](const Json& list, const char* between, auto spell) {
    std::string text;
    for (const Json& each : list) text += (text.empty() ? "" : between) + spell(each);
    return text;
  };
  if (schema.contains("$ref")) return schema_link(last_part(schema["$ref"].get<std::string>()));
  if (schema.contains("oneOf")) return joined(schema["oneOf"], " or ", kind_of);
  if (schema.contains("enum")) {
    return "one of " + joined(schema["enum"], ", ", [](const Json& each) { return "<code>" + escaped(each.get<std::string>()) + "</code>"; });
  }
  if (schema.contains("const")) return "<code>" + escaped(schema["const"].dump()) + "</code>";
  if (schema.contains("items")) return "list of " + kind_of(schema["items"]);
  if (!schema.contains("type")) return "anything";
  if (schema["type"].is_array()) return joined(schema["type"], " or ", [](const Json& each) { return each.get<std::string>(); });
  return schema["type"].get<std::string>() + range_of(schema);
}

std::string row(std::initializer_list<std::string> cells) {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += "<td>" + cell + "</td>";
  return html + "</tr>";
}

std::string properties_table(const Json& schema) {
  if (!schema.contains("properties")) return "";
  std::string html = "<table><tr><th>field</th><th>kind</th><th>meaning</th></tr>";
  for (const auto& [name, property] : schema["properties"].items()) {
    bool needed = false;
    if (schema.contains("required")) {
      for (const Json& each : schema["required"]) needed = needed || each == name;
    }
    const std::string unit = text_of(property, "x-unit");
    html += row({"<code>" + escaped(name) + "</code>", kind_of(property) + (unit.empty() ? "" : " " + escaped(unit)) + (needed ? "" : ", optional"),
                 prose(text_of(property, "description"))});
  }
  return html + "</table>";
}

std::string example_of(const Json& example) {
  return "<pre>" + escaped(example.is_string() ? example.get<std::string>() : example.dump(2)) + "</pre>";
}

std::string content_of(const Json& holder) {
  std::string html = "<p>" + prose(text_of(holder, "description")) + "</p>";
  if (!holder.contains("content")) return html;
  for (const auto& [media_type, content] : holder["content"].items()) {
    const Json& schema = content["schema"];
    html += "<p><code>" + escaped(media_type) + "</code>: " + kind_of(schema) + "</p>";
    if (!schema.contains("$ref")) html += properties_table(schema);
    if (content.contains("example")) html += example_of(content["example"]);
  }
  return html;
}

std::string parameters_table(const Json& document, const Json& operation) {
  if (!operation.contains("parameters")) return "";
  std::string html = "<h3>Parameters</h3><table><tr><th>name</th><th>in</th><th>kind</th><th>meaning</th></tr>";
  for (const Json& given : operation["parameters"]) {
    const Json& parameter = resolved(document, given);
    html += row({"<code>" + escaped(text_of(parameter, "name")) + "</code>", text_of(parameter, "in"), kind_of(parameter["schema"]),
                 prose(text_of(parameter, "description"))});
  }
  return html + "</table>";
}

std::string answers_of(const Json& document, const Json& operation) {
  std::string html = "<h3>Answers</h3>";
  for (const auto& [status, given] : operation["responses"].items()) {
    const Json& response = resolved(document, given);
    html += "<p><b>" + status + "</b> " + prose(text_of(response, "description"));
    if (response.contains("headers")) {
      for (const auto& [name, _] : response["headers"].items()) html += " Header <code>" + escaped(name) + "</code>.";
    }
    // What all faults look like need not be said at each.
    html += given.contains("$ref") ? " A " + schema_link("Problem") + ".</p>" : "</p>" + content_of({{"content", response.value("content", Json::object())}});
  }
  return html;
}

std::string operation_html(const Json& document, const std::string& path, std::string method, const Json& operation) {
  for (char& c : method) c = static_cast<char>(c - 'a' + 'A');
  const Json& security = operation["security"];
  const std::string scope = security.empty() ? "public" : security[0]["key"][0].get<std::string>();
  std::string html = "<details id=\"" + text_of(operation, "operationId") + "\"><summary><span class=\"method " + method + "\">" + method +
                     "</span><code>" + escaped(path) + "</code><span class=\"scope\">" + scope + "</span><span class=\"what\">" +
                     prose(text_of(operation, "summary")) + "</span></summary><div>";
  if (operation.contains("description")) html += "<p>" + prose(text_of(operation, "description")) + "</p>";
  html += parameters_table(document, operation);
  if (operation.contains("requestBody")) html += "<h3>Body</h3>" + content_of(operation["requestBody"]);
  return html + answers_of(document, operation) + "</div></details>";
}

std::string head_of(const Json& document, const std::string& more) {
  const Json& info = document["info"];
  return "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\"><title>" +
         escaped(text_of(info, "title")) + "</title><link rel=\"stylesheet\" href=\"/docs/docs.css\"></head><body><h1>" +
         escaped(text_of(info, "title")) + " " + escaped(text_of(info, "version")) + "</h1><p>" + prose(text_of(info, "description")) + "</p><p>" + more + "</p>";
}

std::string schemas_of(const Json& document) {
  std::string html = "<h2 id=\"schemas\">Schemas</h2>";
  for (const auto& [name, schema] : document["components"]["schemas"].items()) {
    html += "<h3 id=\"schema-" + name + "\">" + name + "</h3><p>" + prose(text_of(schema, "description")) + "</p>" +
            (schema.contains("properties") ? properties_table(schema) : "<p>" + kind_of(schema) + "</p>");
  }
  return html;
}

std::string messages_of(const Json& document, const char* operation) {
  std::string html;
  for (const Json& given : document["operations"][operation]["messages"]) {
    const Json& message = resolved(document, resolved(document, given));
    const std::string name = text_of(message, "name");
    html += "<details id=\"" + name + "\"><summary><span class=\"method\">" + name + "</span><span class=\"what\">" + prose(text_of(message, "summary")) +
            "</span></summary><div>" + properties_table(resolved(document, message["payload"]));
    if (message.contains("examples")) html += example_of(message["examples"][0]["payload"]);
    html += "</div></details>";
  }
  return html;
}

}  // namespace

std::string openapi_page(std::string_view text) {
  const Json document = Json::parse(text);
  std::string html = head_of(document, "The same as <a href=\"/v1/openapi.json\">OpenAPI 3.1</a>. The WebSocket side: <a href=\"/docs/sessions\">sessions</a>.") + "<nav>";
  for (const Json& tag : document["tags"]) html += "<a href=\"#" + text_of(tag, "name") + "\">" + text_of(tag, "name") + "</a>";
  html += "<a href=\"#webhooks\">webhooks</a><a href=\"#schemas\">schemas</a></nav><main>";
  for (const Json& tag : document["tags"]) {
    html += "<h2 id=\"" + text_of(tag, "name") + "\">" + prose(text_of(tag, "description")) + "</h2>";
    for (const auto& [path, item] : document["paths"].items()) {
      for (const char* method : kMethods) {
        if (item.contains(method) && item[method]["tags"][0] == tag["name"]) html += operation_html(document, path, method, item[method]);
      }
    }
  }
  html += "<h2 id=\"webhooks\">What webhooks get</h2>";
  for (const auto& [name, item] : document["webhooks"].items()) html += operation_html(document, name, "post", item["post"]);
  return html + schemas_of(document) + "</main></body></html>\n";
}

std::string asyncapi_page(std::string_view text) {
  const Json document = Json::parse(text);
  return head_of(document, "The same as <a href=\"/v1/asyncapi.json\">AsyncAPI 3</a>. The HTTP side: <a href=\"/docs\">admin API</a>.") +
         "<nav><a href=\"#from_client\">from the client</a><a href=\"#from_server\">from the server</a><a href=\"#schemas\">schemas</a></nav><main>" +
         "<h2 id=\"from_client\">From the client</h2>" + messages_of(document, "from_client") + "<h2 id=\"from_server\">From the server</h2>" +
         messages_of(document, "from_server") + schemas_of(document) + "</main></body></html>\n";
}

}  // namespace wayfuse
