#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace wayfuse {

/// What of a value does not fit a schema of an OpenAPI 3.1 document; empty = it fits. Knows the keywords the document uses, and
/// fails on any other, so that nothing passes for being overlooked.
class SchemaCheck {
 public:
  explicit SchemaCheck(const nlohmann::json& document) : document_(document) {}

  std::string misfit(const nlohmann::json& value, const nlohmann::json& schema, const std::string& at = "") const;
  /// What a reference names; anything else is itself.
  const nlohmann::json& resolved(const nlohmann::json& node) const;

 private:
  std::string kind_misfit(const nlohmann::json& value, const nlohmann::json& type, const std::string& at) const;
  std::string object_misfit(const nlohmann::json& value, const nlohmann::json& schema, const std::string& at) const;

  const nlohmann::json& document_;
};

/// An OpenAPI document to hold answers against.
class ApiDescription {
 public:
  struct Answer {
    int status;
    std::string content_type;
    std::string body;
    std::map<std::string, std::string> headers;
  };
  explicit ApiDescription(nlohmann::json document) : document_(std::move(document)) {}

  /// What of an answer the description does not know: its status, media type, headers or body; empty = all is said. Paths that are
  /// not described have nothing to be held against.
  std::string misfit(const std::string& method, const std::string& path, const Answer& answer) const;

 private:
  const nlohmann::json* operation(const std::string& method, const std::string& path) const;

  const nlohmann::json document_;
};

}  // namespace wayfuse
