#include <benchmark/benchmark.h>
#include <simdjson.h>

#include <nlohmann/json.hpp>
#include <string>

#include "wayfuse/proto/codec.hpp"
#include "wayfuse/proto/random.hpp"

// The scan message of 1.1 KB: one sample, as many access points as fit.
namespace wayfuse {
namespace {

ClientMessage scan_message() {
  Random random(1);
  RssScan scan;
  scan.time = PhoneTime(Duration(81296100000));
  SampleBatch batch;
  while (true) {
    ScanReading reading;
    reading.bssid.value = random.bits() >> 16;
    reading.rss_dbm = -30.0 - static_cast<double>(random.below(60));
    reading.age = Duration(random.below(5'000'000));
    reading.frequency_mhz =
        static_cast<std::uint16_t>(random.below(2) == 0 ? 2412 + 5 * random.below(13) : 5180 + 20 * random.below(8));
    scan.readings.push_back(reading);
    batch.samples = {Sample{119, scan}};
    if (encode(ClientMessage(batch), Encoding::kJson).size() >= 1080) return batch;
  }
}

void report(benchmark::State& state, const std::string& frame) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * frame.size()));
  state.counters["bytes"] = static_cast<double>(frame.size());
}

void decode_scan(benchmark::State& state, Encoding encoding) {
  const std::string frame = encode(scan_message(), encoding);
  for (auto _ : state) {
    auto message = decode_client_message(frame, encoding);
    if (!message) state.SkipWithError("not decoded");
    benchmark::DoNotOptimize(message);
  }
  report(state, frame);
}
BENCHMARK_CAPTURE(decode_scan, json, Encoding::kJson);
BENCHMARK_CAPTURE(decode_scan, cbor, Encoding::kCbor);

void encode_scan(benchmark::State& state, Encoding encoding) {
  const ClientMessage message = scan_message();
  std::string frame;
  for (auto _ : state) {
    frame = encode(message, encoding);
    benchmark::DoNotOptimize(frame);
  }
  report(state, frame);
}
BENCHMARK_CAPTURE(encode_scan, json, Encoding::kJson);
BENCHMARK_CAPTURE(encode_scan, cbor, Encoding::kCbor);

// Baselines: a tree and nothing more; neither ranges nor duplicate keys are checked, no message comes out.
void baseline_nlohmann_dom(benchmark::State& state) {
  const std::string frame = encode(scan_message(), Encoding::kJson);
  for (auto _ : state) {
    auto tree = nlohmann::json::parse(frame);
    benchmark::DoNotOptimize(tree);
  }
  report(state, frame);
}
BENCHMARK(baseline_nlohmann_dom);

// On demand, the fields of the readings in their order.
void baseline_simdjson_on_demand(benchmark::State& state) {
  const simdjson::padded_string frame(encode(scan_message(), Encoding::kJson));
  simdjson::ondemand::parser parser;
  for (auto _ : state) {
    RssScan scan;
    auto document = parser.iterate(frame);
    for (auto sample : document["samples"].get_array()) {
      scan.time = PhoneTime(Duration(sample["time_us"].get_int64().value()));
      for (auto element : sample["readings"].get_array()) {
        ScanReading& reading = scan.readings.emplace_back();
        reading.bssid = *parse_bssid(element["bssid"].get_string().value());
        reading.rss_dbm = element["rss_dbm"].get_double();
        reading.age = Duration(element["age_us"].get_int64().value());
        reading.frequency_mhz = static_cast<std::uint16_t>(element["frequency_mhz"].get_uint64().value());
      }
    }
    benchmark::DoNotOptimize(scan);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * frame.size()));
  state.counters["bytes"] = static_cast<double>(frame.size());
}
BENCHMARK(baseline_simdjson_on_demand);

}  // namespace
}  // namespace wayfuse
