#include <sstream>

#include "tests/fuzz/promises.hpp"
#include "wayfuse/sdk/recording.hpp"

using namespace wayfuse;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream in(std::string(fuzzing::as_text(data, size)));
  auto reader = RecordingReader::open(in);
  if (!reader) {
    fuzzing::fault_is_presentable(reader.fault());
    return 0;
  }
  std::ostringstream copy;
  RecordingWriter writer(copy, reader->header());
  std::size_t events = 0;
  while (true) {
    const auto event = reader->next();
    if (!event) {
      fuzzing::fault_is_presentable(event.fault());
      break;
    }
    if (!*event) break;
    writer.write(**event);
    ++events;
  }
  // What was read can be written and read again.
  std::istringstream again(copy.str());
  auto second = RecordingReader::open(again);
  fuzzing::demand(second.has_value(), "a header is written as it was read", second ? "" : to_string(second.fault()));
  for (; events > 0; --events) {
    const auto event = second->next();
    fuzzing::demand(event && *event, "an event is written as it was read", event ? "" : to_string(event.fault()));
  }
  return 0;
}
