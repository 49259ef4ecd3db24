#include <sys/mman.h>
#include <unistd.h>

#include "admin/cli/survey_file.hpp"
#include "tests/fuzz/promises.hpp"
#include "wayfuse/proto/codec.hpp"

using namespace wayfuse;

// The first byte chooses the format, the rest is the file. Every point that is read can be uploaded, every row that is left out can be
// named on a terminal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("survey", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (size == 0) return 0;
  constexpr std::string_view kFormats[] = {"csv", "geojson", "uji"};
  fuzzing::demand(::ftruncate(file, 0) == 0 && ::pwrite(file, data + 1, size - 1, 0) == static_cast<ssize_t>(size - 1), "a file in memory");
  cli::SurveyFileSettings settings;
  settings.format = kFormats[data[0] % std::size(kFormats)];
  settings.georeference = Georeference{{39.9929, -0.0677}, 0.3};
  const auto read = cli::read_survey_file(path, settings);
  if (!read) {
    fuzzing::fault_is_presentable(read.fault());
    return 0;
  }
  fuzzing::demand(read->bad.size() <= read->rows, "a bad row is a row");
  for (const cli::RowFault& row : read->bad) {
    fuzzing::demand(row.row > 0 && !row.cause.empty(), "a bad row says where and why");
    const std::string text = to_string(row);
    fuzzing::demand(wire::is_utf8(text) && !wire::has_controls(text), "a bad row can be shown", text);
  }
  for (const std::string& note : read->notes) fuzzing::demand(wire::is_utf8(note) && !wire::has_controls(note), "a note can be shown", note);
  for (const ReferencePoint& point : read->points) {
    const auto good = check(point, "point");
    fuzzing::demand(good.has_value(), "a point can be uploaded", good ? "" : to_string(good.fault()));
  }
  return 0;
}
