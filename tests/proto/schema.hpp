#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tests/proto/field_table.hpp"
#include "tests/proto/readme_sections.hpp"

namespace wayfuse {

using OrderedJson = nlohmann::ordered_json;

/// Visits the field tables and writes them as JSON Schema, with the meanings from proto/README.md.
class SchemaWriter {
 public:
  static constexpr bool kReads = false;

  explicit SchemaWriter(std::map<std::string, ReadmeSection> readme) : readme_(std::move(readme)) {}

  /// Schemas of the messages and of every map inside them, by component name.
  template <typename... Alternatives>
  void messages(const std::variant<Alternatives...>*) {
    (message(Alternatives{}), ...);
  }
  const OrderedJson& schemas() const { return schemas_; }

  template <typename T, typename K>
  void required(std::string_view name, const T& value, const K& kind) {
    here_["required"].push_back(name);
    property(name, value, kind);
  }
  template <typename T, typename K>
  void optional(std::string_view name, const std::optional<T>&, const K& kind) {
    property(name, T{}, kind);
  }
  template <typename T, typename K>
  void defaulted(std::string_view name, const T& value, const K& kind, const T& = T{}) {
    property(name, value, kind);
  }
  void information(std::string_view name, std::string_view) { here_["properties"][std::string(name)] = of_type("string"); }
  template <typename... Alternatives>
  void alternatives(std::string_view tag, const std::variant<Alternatives...>&) {
    (later(Alternatives{}), ...);
    (here_["oneOf"].push_back(tagged(tag, kPartName<Alternatives>, reference<Alternatives>())), ...);
  }
  template <typename Test>
  void expect(std::string_view, FaultCode, const char*, const Test&) {}

 private:
  template <typename T>
  static std::string component() {
    std::string name(kPartName<T>);
    std::ranges::replace(name, ' ', '_');
    return name;
  }
  template <typename T>
  static OrderedJson reference() {
    OrderedJson reference;
    reference["$ref"] = "#/components/schemas/" + component<T>();
    return reference;
  }
  static OrderedJson of_type(std::string_view type) {
    OrderedJson schema;
    schema["type"] = type;
    return schema;
  }
  static OrderedJson tagged(std::string_view tag, std::string_view name, OrderedJson rest) {
    OrderedJson constant;
    constant["type"] = "object";
    constant["required"].push_back(tag);
    constant["properties"][std::string(tag)]["const"] = name;
    OrderedJson both;
    both["allOf"].push_back(std::move(constant));
    both["allOf"].push_back(std::move(rest));
    return both;
  }

  template <typename T>
  void message(const T& value) {
    later(value);
    OrderedJson& schema = schemas_[component<T>()];
    schema["properties"]["type"]["const"] = kPartName<T>;
    schema["required"].push_back("type");
  }
  template <typename T>
  void later(const T& value) {
    const std::string name = component<T>();
    if (schemas_.contains(name)) return;
    schemas_[name] = nullptr;  // keeps its place in the order, and ends a recursion
    OrderedJson outer = std::exchange(here_, of_type("object"));
    const ReadmeSection* section = std::exchange(section_, &readme_[std::string(kPartName<T>)]);
    if (!section_->words.empty()) here_["description"] = section_->words;
    wire::describe(*this, value);
    schemas_[name] = std::exchange(here_, std::move(outer));
    section_ = section;
  }

  template <typename T, typename K>
  void property(std::string_view name, const T& value, const K& kind) {
    nested(value, kind);
    OrderedJson schema = of(value, kind);
    const std::string key = '`' + std::string(name) + '`';
    for (const ReadmeRow& row : section_->rows) {
      if (row[0] == key && !schema.contains("$ref")) schema["description"] = row[4];
    }
    here_["properties"][std::string(name)] = std::move(schema);
  }

  static OrderedJson numeric(const char* type, OrderedJson least, OrderedJson most, std::string_view unit) {
    OrderedJson schema = {{"type", type}, {"minimum", std::move(least)}, {"maximum", std::move(most)}};
    if (!unit.empty()) schema["x-unit"] = unit;
    return schema;
  }
  template <typename T>
  static OrderedJson of(const T&, const wire::Real& kind) {
    return numeric("number", kind.least, kind.most, kind.unit);
  }
  template <typename T>
  static OrderedJson of(const T&, const wire::Integer& kind) {
    return numeric("integer", kind.least, kind.most, kind.unit);
  }
  template <typename T>
  static OrderedJson of(const T&, wire::Compass) {
    return numeric("number", 0, 360, "deg");
  }
  template <typename T>
  static OrderedJson of(const T&, wire::Flag) {
    return of_type("boolean");
  }
  template <typename T>
  static OrderedJson of(const T&, const wire::Text& kind) {
    OrderedJson schema = of_type("string");
    if (kind.least > 0) schema["minLength"] = kind.least;
    schema["maxLength"] = kind.most;
    if (kind.key) schema["pattern"] = "^[A-Za-z0-9._-]*$";
    return schema;
  }
  template <typename T>
  static OrderedJson of(const T&, const wire::Cause& kind) {
    return {{"type", "string"}, {"maxLength", kind.most}};
  }
  template <typename T>
  static OrderedJson of(const T&, const wire::Choice& kind) {
    OrderedJson schema = of_type("string");
    for (const std::string_view name : kind.names) schema["enum"].push_back(name);
    return schema;
  }
  template <typename T>
  static OrderedJson of(const T&, wire::Address) {
    return {{"type", "string"}, {"pattern", "^[0-9A-Fa-f]{2}([:-]?[0-9A-Fa-f]{2}){5}$"}};
  }
  template <typename T>
  static OrderedJson of(const T&, const wire::Bytes& kind) {
    return {{"type", "string"}, {"contentEncoding", "base64"}, {"maxLength", (kind.most + 2) / 3 * 4}};
  }
  template <typename T>
  static OrderedJson of(const T&, wire::Object) {
    return reference<T>();
  }
  template <typename T, typename K>
  static OrderedJson of(const std::vector<T>&, const wire::List<K>& kind) {
    return {{"type", "array"}, {"minItems", kind.least}, {"maxItems", kind.most}, {"items", of(T{}, kind.element)}};
  }

  template <typename T, typename K>
  void nested(const T&, const K&) {}
  template <typename T>
  void nested(const T& value, wire::Object) {
    later(value);
  }
  template <typename T>
  void nested(const std::vector<T>&, const wire::List<wire::Object>&) {
    later(T{});
  }

  std::map<std::string, ReadmeSection> readme_;
  const ReadmeSection* section_ = nullptr;
  OrderedJson here_;
  OrderedJson schemas_ = OrderedJson::object();
};

/// The streaming side as an AsyncAPI 3 document, from the server's point of view.
inline OrderedJson asyncapi_document() {
  auto readme = readme_sections();
  SchemaWriter writer(readme);
  writer.messages(static_cast<const ClientMessage*>(nullptr));
  writer.messages(static_cast<const ServerMessage*>(nullptr));

  OrderedJson document = {
      {"asyncapi", "3.0.0"},
      {"info",
       {{"title", "wayfuse sessions"},
        {"version", "1"},
        {"description",
         "WebSocket subprotocols wayfuse.v1.json (text frames) and wayfuse.v1.cbor (binary frames, the same maps in CBOR). "
         "Unknown fields are ignored; null means absent. The whole contract: proto/README.md."}}},
      {"defaultContentType", "application/json"}};
  // Apart until the end: a reference into an ordered map does not outlive the next member.
  OrderedJson channel;
  OrderedJson operations;
  OrderedJson components;
  channel["address"] = "/v1/session";
  channel["description"] = "One WebSocket, one message a frame. The first message is hello.";
  channel["bindings"]["ws"]["method"] = "GET";
  const auto operation = [&]<typename... T>(const char* name, const char* action, const std::variant<T...>*) {
    OrderedJson entry;
    entry["action"] = action;
    entry["channel"]["$ref"] = "#/channels/session";
    const auto add = [&](std::string_view type) {
      const std::string key(type);
      channel["messages"][key]["$ref"] = "#/components/messages/" + key;
      OrderedJson use;
      use["$ref"] = "#/channels/session/messages/" + key;
      entry["messages"].push_back(std::move(use));
      OrderedJson& message = components["messages"][key];
      message["name"] = key;
      message["summary"] = readme[key].words;
      message["payload"]["$ref"] = "#/components/schemas/" + key;
      for (const std::string& block : readme[key].blocks) {
        OrderedJson example;
        example["payload"] = OrderedJson::parse(block);
        message["examples"].push_back(std::move(example));
      }
    };
    (add(wire::kWireName<T>), ...);
    operations[name] = std::move(entry);
  };
  operation("from_client", "receive", static_cast<const ClientMessage*>(nullptr));
  operation("from_server", "send", static_cast<const ServerMessage*>(nullptr));
  components["schemas"] = writer.schemas();
  document["channels"]["session"] = std::move(channel);
  document["operations"] = std::move(operations);
  document["components"] = std::move(components);
  return document;
}

}  // namespace wayfuse
