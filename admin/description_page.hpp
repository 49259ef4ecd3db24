#pragma once

#include <string>
#include <string_view>

namespace wayfuse {

/// An OpenAPI 3.1 document as one HTML page to read, without a script: operations by tag, parameters, bodies with examples,
/// answers, webhooks, schemas. What it refers to must exist; a test holds the document to that.
std::string openapi_page(std::string_view document);

/// An AsyncAPI 3 document likewise: messages by who sends them, with examples, then schemas.
std::string asyncapi_page(std::string_view document);

}  // namespace wayfuse
