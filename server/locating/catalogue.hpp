#pragma once

#include <memory>
#include <span>

#include "server/locating/locator.hpp"
#include "server/locating/radio_map.hpp"
#include "wayfuse/proto/part.hpp"
#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// What locators are made from. Whatever a locator precomputes per building it makes in LocatorRow::prepare.
struct LocatingSite {
  std::shared_ptr<const RadioMap> map;
  std::span<const ReferencePoint> survey;   ///< raw, with every scan; valid during prepare() only
  std::span<const Floor> floors;            ///< valid during prepare() only
};

/// A locator prepared for one building: makes one object a session. Immutable and thread-safe.
class LocatorModel {
 public:
  virtual ~LocatorModel() = default;
  virtual std::unique_ptr<Locator> make() const = 0;
};

/// A row of this room's catalogue (`none` has no prepare). How a locator is added: the room's README.
struct LocatorRow {
  PartDescription description;
  std::shared_ptr<const LocatorModel> (*prepare)(const LocatingSite& site, const PartSettings& settings);
  bool gives_fix = true;           ///< for the `fix` measurement
  bool gives_ranges = false;       ///< for the `ranges` measurement
  bool gives_likelihood = false;   ///< for the `field` measurement
};

std::span<const LocatorRow> locator_catalogue();

}  // namespace wayfuse
