#include "admin/json_forms.hpp"
#include "tests/fuzz/promises.hpp"

using namespace wayfuse;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzzing::as_text(data, size);
  const auto building = parse_building(text);
  if (!building) {
    fuzzing::fault_is_presentable(building.fault());
  } else {  // what was taken can be shown, and taken again
    const auto again = parse_building(to_json(*building, 0, 0));
    fuzzing::demand(again.has_value(), "a building is taken as it is shown", again ? "" : to_string(again.fault()));
  }
  if (const auto floors = parse_floors(text); !floors) fuzzing::fault_is_presentable(floors.fault());
  const auto zone = parse_zone(text);
  if (!zone) {
    fuzzing::fault_is_presentable(zone.fault());
  } else {
    fuzzing::demand(parse_zone(to_json(*zone)).has_value(), "a zone is taken as it is shown");
  }
  const auto key = parse_key(text, UnixTime(Duration(1'700'000'000'000'000)));
  if (!key) {
    fuzzing::fault_is_presentable(key.fault());
  } else {
    fuzzing::demand(!to_json(*key, "secret").empty(), "a key can be shown");
  }
  return 0;
}
