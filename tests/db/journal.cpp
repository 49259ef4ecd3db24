#include "tests/db/journal.hpp"

#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace wayfuse::testing {
namespace {

constexpr std::string_view kLineEnd = " .\n";

std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%a", value);
  return text;
}

std::string hex(std::uint64_t value) {
  char text[20];
  std::snprintf(text, sizeof text, "%016" PRIx64, value);
  return text;
}

}  // namespace

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

std::string spell(const ReferencePoint& point) {
  std::string text = exact(point.place.point.x_m) + ' ' + exact(point.place.point.y_m) + ' ' + std::to_string(point.place.floor.value) + ' ' +
                     exact(point.sigma_m) + ' ' + std::to_string(point.surveyed_at.time_since_epoch().count()) + '\n' +
                     point.device_model + '\n' + point.walk + '\n';
  for (const RssScan& scan : point.scans) {
    text += "scan " + std::to_string(scan.time.time_since_epoch().count()) + '\n';
    for (const ScanReading& reading : scan.readings) {
      text += hex(reading.bssid.value) + ' ' + exact(reading.rss_dbm) + ' ' + std::to_string(reading.age.count()) + ' ' +
              std::to_string(reading.frequency_mhz) + ' ' + (reading.range_m ? exact(*reading.range_m) : "-") + ' ' +
              (reading.range_sigma_m ? exact(*reading.range_sigma_m) : "-") + '\n';
    }
  }
  return text;
}

std::string sent_line(const SurveyBatch& batch) {
  std::string line = "sent " + batch.idempotency_key;
  for (const ReferencePoint& point : batch.points) line += ' ' + hex(fnv1a(spell(point)));
  return line.append(kLineEnd);
}

std::string acked_line(const SurveyAck& ack) {
  return "acked " + ack.idempotency_key + ' ' + std::to_string(ack.stored) + ' ' + std::to_string(ack.survey_version) + std::string(kLineEnd);
}

void read_journal(const std::filesystem::path& file, Journal& journal) {
  std::ifstream in(file);
  note(std::string((std::istreambuf_iterator<char>(in)), {}), journal);
}

void note(std::string_view all, Journal& journal) {
  for (std::size_t begin = 0, end; (end = all.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string_view line = all.substr(begin, end + 1 - begin);
    if (!line.ends_with(kLineEnd)) continue;
    std::istringstream words(std::string(line.substr(0, line.size() - kLineEnd.size())));
    std::string what, key;
    if (!(words >> what >> key)) continue;
    if (what == "sent") {
      JournalEntry entry;
      for (std::string digest; words >> digest;) entry.digests.push_back(std::stoull(digest, nullptr, 16));
      journal.try_emplace(key, std::move(entry));
    } else if (what == "acked") {
      JournalEntry& entry = journal[key];
      std::uint64_t stored = 0, version = 0;
      if (!(words >> stored >> version)) continue;
      entry.answers_differ |= entry.acked && (entry.stored != stored || entry.survey_version != version);
      entry.acked = true;
      entry.stored = stored;
      entry.survey_version = version;
    }
  }
}

}  // namespace wayfuse::testing
