#pragma once

#include <filesystem>
#include <functional>

#include "db/building_database.hpp"
#include "tests/evaluation/datasets/recorded_site.hpp"
#include "wayfuse/sdk/client.hpp"

namespace wayfuse {

/// A folder of its own that goes away with it.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What an operator would enter for the site: floors and georeference.
BuildingRecord record_of(const RecordedSite& site);

/// A survey walk through the SDK's surveyor.
Result<std::vector<SurveyBatch>> batches_of(const RecordedWalk& walk);

/// Settings of a phone in this program.
ClientSettings phone_settings(Role role, BuildingId building, std::string device_model);

/// Uploads all walks through a client; `work` lets the client's world go on for a moment. Ends when everything is acknowledged.
/// A walk that the surveyor does not take is left out, and named on stderr. `refused` is the client's own fault event. `spoil`, if any, changes batches before they go up.
Result<void> upload_survey(Client& client, const std::vector<RecordedWalk>& survey, const std::optional<Fault>& refused,
                           const std::function<void()>& work,
                           const std::function<void(std::vector<SurveyBatch>&)>& spoil = {});

}  // namespace wayfuse
