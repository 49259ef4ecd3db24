#include "admin/plan/image_header.hpp"
#include "admin/plan/plan.hpp"
#include "tests/fuzz/promises.hpp"

using namespace wayfuse;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzzing::as_text(data, size);
  if (const auto image = image_header(text); !image) fuzzing::fault_is_presentable(image.fault());
  PlanOptions options;
  options.floor = FloorOrdinal{0};
  auto plan = read_plan(text, options);
  if (!plan) {
    fuzzing::fault_is_presentable(plan.fault());
    return 0;
  }
  for (const Floor& floor : floors_of(*plan, options)) {
    for (const Ring& ring : floor.outline.rings) fuzzing::demand(ring.size() >= 3, "an outline's rings have three points");
    for (const Polyline& wall : floor.walls) fuzzing::demand(wall.size() >= 2 || !plan->sound(), "a wall has two ends");
  }
  return 0;
}
