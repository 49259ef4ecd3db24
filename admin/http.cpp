#include "admin/http.hpp"

#include <nlohmann/json.hpp>

namespace wayfuse {

Response problem(const Fault& fault, int status) {
  const FaultFace& face = face_of(fault.code);
  if (status == 0) status = face.http_status;
  nlohmann::json document = {{"type", "urn:wayfuse:fault:" + std::string(face.name)},
                             {"title", face.summary},
                             {"status", status},
                             {"code", face.name}};
  if (!fault.field.empty()) document["field"] = fault.field;
  if (!fault.cause.empty()) document["detail"] = fault.cause;
  Response response;
  response.status = status;
  response.content_type = "application/problem+json";
  response.body = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (response.status == 401) response.headers["WWW-Authenticate"] = "Bearer";
  return response;
}

}  // namespace wayfuse
