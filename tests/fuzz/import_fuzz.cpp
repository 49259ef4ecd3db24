#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>

#include "sdk/src/recording/import/import.hpp"
#include "tests/fuzz/promises.hpp"

using namespace wayfuse;

// The first byte chooses the format, the rest is the file. What is read is in time order, and whatever is said of it can be shown.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("import", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (size == 0) return 0;
  constexpr std::string_view kFormats[] = {"ilc20", "getsensordata", "broad", "oxford-steps"};
  const std::string_view format = kFormats[data[0] % std::size(kFormats)];
  fuzzing::demand(::ftruncate(file, 0) == 0 && ::pwrite(file, data + 1, size - 1, 0) == static_cast<ssize_t>(size - 1), "a file in memory");
  const auto recording = import_recording(format, path, {});
  if (!recording) {
    fuzzing::fault_is_presentable(recording.fault());
    return 0;
  }
  for (const std::string& complaint : recording->complaints) {
    fuzzing::demand(wire::is_utf8(complaint) && !wire::has_controls(complaint), "a complaint can be shown", complaint);
  }
  fuzzing::demand(std::ranges::is_sorted(recording->events, {}, [](const RecordedEvent& event) { return time_of(event); }), "events are in order");
  return 0;
}
