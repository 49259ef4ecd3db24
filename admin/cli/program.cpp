#include "admin/cli/program.hpp"

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "admin/cli/table.hpp"

namespace wayfuse::cli {

std::string content_of(const std::string& file) {
  if (file == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + " cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_content(const std::string& file, const std::string& content) {
  if (file == "-") {
    std::cout.write(content.data(), static_cast<std::streamsize>(content.size()));
    return;
  }
  std::ofstream out(file, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) throw std::runtime_error(file + " cannot be written");
}

int refused(const Reply& reply) {
  const auto problem = nlohmann::json::parse(reply.body, nullptr, false);
  std::cerr << "wayfuse: the server refused";
  if (problem.is_object()) {
    for (const char* part : {"title", "field", "detail"}) {
      if (problem.contains(part) && problem[part].is_string() && !problem[part].get<std::string>().empty()) {
        std::cerr << ": " << problem[part].get<std::string>();
      }
    }
  }
  std::cerr << " (HTTP " << reply.status << ")\n";
  return EXIT_FAILURE;
}

int perform(const Program& program, const Call& call) {
  const auto reply = exchange(program.connection, call.method, call.path, call.body, call.content_type, call.headers);
  if (!reply) {
    std::cerr << "wayfuse: " << reply.fault().cause << "\n";
    return EXIT_FAILURE;
  }
  if (reply->status >= 400) return refused(*reply);
  if (call.raw || program.json) {
    std::cout << reply->body << (call.raw ? "" : "\n");
  } else if (!reply->body.empty()) {
    std::cout << (call.show ? call.show(reply->body) : readable(reply->body, call.list, call.fields));
  }
  return EXIT_SUCCESS;
}

std::string building_path(const Program& program, const std::string& what) {
  return "/v1/buildings/" + escaped(program.building) + what;
}

std::string escaped(const std::string& text) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string escaped;
  for (const unsigned char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.' || c == '~';
    if (plain) {
      escaped += static_cast<char>(c);
    } else {
      escaped += {'%', kDigits[c >> 4], kDigits[c & 15]};
    }
  }
  return escaped;
}

}  // namespace wayfuse::cli
