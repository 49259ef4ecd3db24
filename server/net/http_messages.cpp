#include "server/net/http_messages.hpp"

#include <algorithm>
#include <cctype>

#include "server/net/target.hpp"

namespace wayfuse {
namespace {

namespace http = boost::beast::http;

void put_fields(http::fields& fields, const Response& response) {
  for (const auto& [name, value] : response.headers) fields.set(name, value);
  fields.set(http::field::server, "wayfuse");
}

}  // namespace

Result<Request> request_from(const HttpRequest& message, const std::string& peer) {
  auto target = parse_target({message.target().data(), message.target().size()});
  if (!target) return target.fault();
  Request request;
  request.method = message.method() == http::verb::head ? "GET" : std::string(message.method_string());
  request.path = std::move(target->path);
  request.query = std::move(target->query);
  for (const auto& field : message) {
    std::string name(field.name_string());
    std::ranges::transform(name, name.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    const auto [place, fresh] = request.headers.try_emplace(std::move(name), field.value());
    if (!fresh) place->second += ", " + std::string(field.value());
  }
  request.body = message.body();
  request.peer = peer;
  return request;
}

HttpResponse whole_answer(Response response, unsigned version, bool head_only) {
  HttpResponse answer(static_cast<http::status>(response.status), version);
  put_fields(answer, response);
  if (response.stream) {  // its length is not known
    answer.set(http::field::content_type, response.content_type);
    return answer;
  }
  if (!response.body.empty()) answer.set(http::field::content_type, response.content_type);
  answer.content_length(response.body.size());
  if (!head_only) answer.body() = std::move(response.body);
  return answer;
}

HttpHead head_of(const Response& response, unsigned version) {
  HttpHead head(static_cast<http::status>(response.status), version);
  put_fields(head, response);
  head.set(http::field::content_type, response.content_type);
  return head;
}

}  // namespace wayfuse
