#include "db/floor_images.hpp"

namespace wayfuse {
namespace {

StoreError unknown(FloorOrdinal floor) {
  return StoreError({FaultCode::kNotFound, "floor", "floor " + std::to_string(floor.value) + " has no image"});
}

}  // namespace

void write_floor_image(SqliteConnection& connection, const FloorImage& image) {
  Transaction transaction(connection);
  Statement insert = connection.prepare(
      "INSERT OR REPLACE INTO floor_image (ordinal, media_type, width_px, height_px, origin_x_m, origin_y_m, width_m, height_m, "
      "azimuth_rad, content) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(1, std::int64_t{image.floor.value}).bind_text(2, image.media_type).bind(3, std::int64_t{image.width_px});
  insert.bind(4, std::int64_t{image.height_px}).bind(5, image.origin.x_m).bind(6, image.origin.y_m).bind(7, image.width_m);
  insert.bind(8, image.height_m).bind(9, image.azimuth_rad).bind_blob(10, image.content).run();
  transaction.commit();
}

FloorImage read_floor_image(SqliteConnection& connection, FloorOrdinal floor) {
  Statement select = connection.prepare(
      "SELECT media_type, width_px, height_px, origin_x_m, origin_y_m, width_m, height_m, azimuth_rad, content FROM floor_image "
      "WHERE ordinal = ?");
  if (!select.bind(1, std::int64_t{floor.value}).step()) throw unknown(floor);
  return {floor,
          std::string(select.text(0)),
          static_cast<std::uint32_t>(select.integer(1)),
          static_cast<std::uint32_t>(select.integer(2)),
          {select.real(3), select.real(4)},
          select.real(5),
          select.real(6),
          select.real(7),
          std::string(select.blob(8))};
}

std::vector<FloorOrdinal> read_floors_with_image(SqliteConnection& connection) {
  std::vector<FloorOrdinal> floors;
  Statement select = connection.prepare("SELECT ordinal FROM floor_image ORDER BY ordinal");
  while (select.step()) floors.push_back({static_cast<std::int32_t>(select.integer(0))});
  return floors;
}

void remove_floor_image(SqliteConnection& connection, FloorOrdinal floor) {
  Transaction transaction(connection);
  Statement erase = connection.prepare("DELETE FROM floor_image WHERE ordinal = ?");
  if (erase.bind(1, std::int64_t{floor.value}).run() == 0) throw unknown(floor);
  transaction.commit();
}

}  // namespace wayfuse
