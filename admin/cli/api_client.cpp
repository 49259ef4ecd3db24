#include "admin/cli/api_client.hpp"

#include <curl/curl.h>

#include <algorithm>
#include <cctype>
#include <memory>

namespace wayfuse::cli {
namespace {

struct Curl {
  Curl() { curl_global_init(CURL_GLOBAL_DEFAULT); }
  ~Curl() { curl_global_cleanup(); }
};

/// One request and what comes back.
struct Exchange {
  explicit Exchange(const Connection& to, const std::string& path, const std::map<std::string, std::string>& more)
      : server(to.server), handle(curl_easy_init(), curl_easy_cleanup), url(to.server + path) {
    curl_slist* list = nullptr;
    if (!to.key.empty()) list = curl_slist_append(list, ("authorization: Bearer " + to.key).c_str());
    for (const auto& [name, value] : more) list = curl_slist_append(list, (name + ": " + value).c_str());
    headers.reset(list);
    if (!handle) return;
    curl_easy_setopt(handle.get(), CURLOPT_URL, url.c_str());
    curl_easy_setopt(handle.get(), CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(handle.get(), CURLOPT_HTTPHEADER, headers.get());
    curl_easy_setopt(handle.get(), CURLOPT_CONNECTTIMEOUT, 10L);
    curl_easy_setopt(handle.get(), CURLOPT_WRITEFUNCTION, take_body);
    curl_easy_setopt(handle.get(), CURLOPT_WRITEDATA, this);
    curl_easy_setopt(handle.get(), CURLOPT_HEADERFUNCTION, take_header);
    curl_easy_setopt(handle.get(), CURLOPT_HEADERDATA, this);
    curl_easy_setopt(handle.get(), CURLOPT_ERRORBUFFER, error);
    curl_easy_setopt(handle.get(), CURLOPT_NOSIGNAL, 1L);
    if (!to.authority.empty()) curl_easy_setopt(handle.get(), CURLOPT_CAINFO, to.authority.c_str());
  }

  Result<Reply> perform() {
    if (!handle) return Fault{FaultCode::kInternal, "", "libcurl does not start"};
    const CURLcode done = curl_easy_perform(handle.get());
    if (done != CURLE_OK && !enough) {
      return Fault{FaultCode::kTimeout, "server", server + ": " + (error[0] ? error : curl_easy_strerror(done))};
    }
    reply.status = status();
    return std::move(reply);
  }

  int status() const {
    long code = 0;
    curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &code);
    return static_cast<int>(code);
  }

  static std::size_t take_body(char* data, std::size_t size, std::size_t count, void* self) {
    auto& exchange = *static_cast<Exchange*>(self);
    if (!exchange.take || exchange.status() >= 400) {
      exchange.reply.body.append(data, size * count);
    } else if (!exchange.take({data, size * count})) {
      exchange.enough = true;
      return 0;
    }
    return size * count;
  }

  static std::size_t take_header(char* data, std::size_t size, std::size_t count, void* self) {
    std::string_view line(data, size * count);
    while (!line.empty() && (line.back() == '\r' || line.back() == '\n')) line.remove_suffix(1);
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return size * count;
    std::string name(line.substr(0, colon));
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    line.remove_prefix(colon + 1);
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    static_cast<Exchange*>(self)->reply.headers[name] = line;
    return size * count;
  }

  const std::string server;
  std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> handle;
  std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers{nullptr, curl_slist_free_all};
  const std::string url;
  std::function<bool(std::string_view)> take;
  bool enough = false;
  Reply reply;
  char error[CURL_ERROR_SIZE] = "";
};

}  // namespace

Result<Reply> exchange(const Connection& connection, const std::string& method, const std::string& path, const std::string& body,
                       const std::string& content_type, const std::map<std::string, std::string>& headers) {
  static const Curl library;
  std::map<std::string, std::string> all = headers;
  all["content-type"] = content_type;
  Exchange exchange(connection, path, all);
  curl_easy_setopt(exchange.handle.get(), CURLOPT_CUSTOMREQUEST, method.c_str());
  // Large backups take their time; a line that stands still does not count as one.
  curl_easy_setopt(exchange.handle.get(), CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(exchange.handle.get(), CURLOPT_LOW_SPEED_TIME, 120L);
  if (!body.empty()) {
    curl_easy_setopt(exchange.handle.get(), CURLOPT_POSTFIELDS, body.data());
    curl_easy_setopt(exchange.handle.get(), CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
  }
  return exchange.perform();
}

Result<Reply> follow(const Connection& connection, const std::string& path, const std::map<std::string, std::string>& headers,
                     const std::function<bool(std::string_view)>& take) {
  static const Curl library;
  Exchange exchange(connection, path, headers);
  exchange.take = take;
  return exchange.perform();
}

}  // namespace wayfuse::cli
