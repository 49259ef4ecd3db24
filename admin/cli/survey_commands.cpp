#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "admin/cli/program.hpp"
#include "admin/cli/survey_import.hpp"

namespace wayfuse::cli {
namespace {

constexpr std::size_t kRowsNamed = 20;
constexpr std::size_t kBarWidth = 30;

/// A bar that grows in place on a terminal; elsewhere silence.
Progress progress_bar() {
  if (::isatty(STDERR_FILENO) == 0) return [](std::size_t, std::size_t) {};
  return [](std::size_t done, std::size_t all) {
    const std::size_t full = kBarWidth * done / all;
    std::fprintf(stderr, "\r[%s%s] %3zu %%  %zu of %zu batches%s", std::string(full, '#').c_str(), std::string(kBarWidth - full, '.').c_str(),
                 100 * done / all, done, all, done == all ? "\n" : "");
  };
}

void say_rows(const ImportReport& report) {
  std::size_t named = 0, bad = 0;
  for (const SurveyFile& file : report.files) {
    for (const std::string& note : file.notes) std::cerr << note << "\n";
    for (const RowFault& row : file.bad) {
      ++bad;
      if (named < kRowsNamed) std::cerr << to_string(row) << "\n", ++named;
    }
  }
  if (bad > named) std::cerr << ".. and " << bad - named << " rows more; --json lists them all\n";
}

int run_import(const Program& program, const ImportOrder& order) {
  const Ask ask = [&](const std::string& method, const std::string& path, const std::string& body) {
    return exchange(program.connection, method, path, body);
  };
  const ImportReport report = import_survey(order, ask, progress_bar());
  const bool bar_stands = report.uploaded + report.already_there > 0 && report.uploaded + report.already_there < report.batches;
  if (bar_stands && ::isatty(STDERR_FILENO) != 0) std::cerr << "\n";
  if (program.json) {
    std::cout << to_json(order, report) << "\n";
    return report.complaints.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  say_rows(report);
  std::size_t rows = 0, bad = 0;
  for (const SurveyFile& file : report.files) rows += file.rows, bad += file.bad.size();
  if (report.batches > 0) {
    std::cout << report.points << " points from " << rows << " rows of " << report.files.size() << (report.files.size() == 1 ? " file" : " files");
    if (bad > 0) std::cout << ", " << bad << " rows left out";
    if (order.dry_run) std::cout << ", in " << report.batches << " batches; nothing was uploaded (--dry-run)\n";
    else std::cout << ": " << report.uploaded << " of " << report.batches << " batches uploaded, " << report.already_there << " were there already\n";
  }
  for (const std::string& complaint : report.complaints) std::cerr << "wayfuse: " << complaint << "\n";
  return report.complaints.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

void add_import_command(CLI::App& survey, Program& program) {
  auto* import = survey.add_subcommand("import", "Reference points from files: CSV, GeoJSON, UJIIndoorLoc, Indoor Location Competition 2.0, GetSensorData");
  auto order = std::make_shared<ImportOrder>();
  auto floor = std::make_shared<std::optional<std::int32_t>>();
  std::vector<std::string> formats(survey_formats().begin(), survey_formats().end());
  import->add_option("BUILDING", order->building)->required();
  import->add_option("FILE", order->files, "One or more; none is uploaded before all are read")->required()->check(CLI::ExistingFile);
  import->add_option("--format", order->settings.format, "Where the content does not tell it")->check(CLI::IsMember(formats));
  import->add_option("--floor", *floor, "Ordinal, where the file tells none")->check(CLI::Range(-200, 1000));
  import->add_option("--device-model", order->settings.device_model, "Of the phone, where the file tells none");
  import->add_option("--source-building", order->settings.source_building, "UJIIndoorLoc: rows with this BUILDINGID only");
  import->add_flag("--skip-bad", order->skip_bad, "Upload the good rows although some are bad; the bad ones are counted and named");
  import->add_flag("--dry-run", order->dry_run, "Read and check, upload nothing");
  import->callback([&program, order, floor] {
    if (*floor) order->settings.floor = FloorOrdinal{**floor};
    program.run = [&program, order] { return run_import(program, *order); };
  });
}

}  // namespace

void add_survey_commands(CLI::App& app, Program& program) {
  auto* survey = app.add_subcommand("survey", "Reference points and access points")->require_subcommand(1);
  const auto at = [&](const char* what) { return "/v1/buildings/" + program.building + what; };
  auto* upload = survey->add_subcommand("upload", "Upload a survey document (proto/README.md), - = standard input");
  upload->add_option("BUILDING", program.building)->required();
  upload->add_option("FILE", program.file)->required();
  upload->callback([&program, at] { program.call = {"POST", at("/points"), content_of(program.file), "", {}}; });
  add_import_command(*survey, program);
  auto* uploads = survey->add_subcommand("uploads", "Batches that are stored");
  uploads->add_option("BUILDING", program.building)->required();
  uploads->callback([&program, at] {
    program.call = {"GET", at("/uploads?most=1000"), "", "items", {"id", "idempotency_key", "points", "survey_version"}};
  });
  auto* dump = survey->add_subcommand("export", "Every reference point, to standard output");
  dump->add_option("BUILDING", program.building)->required();
  dump->add_option("--format", program.format, "csv or geojson")->check(CLI::IsMember({"csv", "geojson"}));
  dump->callback([&program, at] { program.call = {"GET", at(("/points." + program.format).c_str()), "", "", {}, true}; });
  auto* transmitters = survey->add_subcommand("transmitters", "Access points as the survey heard them");
  transmitters->add_option("BUILDING", program.building)->required();
  transmitters->callback([&program, at] {
    program.call = {"GET", at("/transmitters"), "", "transmitters", {"bssid", "frequency_mhz", "readings", "strongest_dbm"}};
  });
}

}  // namespace wayfuse::cli
