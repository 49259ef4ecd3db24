#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "db/access_point_record.hpp"
#include "db/corrector_record.hpp"
#include "db/floor_image.hpp"
#include "db/radio_map_record.hpp"
#include "db/walk_part_record.hpp"
#include "db/webhook_record.hpp"
#include "db/zone_record.hpp"
#include "wayfuse/proto/fingerprint.hpp"
#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A building as an operator describes it.
struct BuildingRecord {
  BuildingId id;
  std::string name;
  std::optional<Georeference> georeference;
  MagneticField magnetic_field;
  std::vector<Floor> floors;
  std::string pipeline = "default";      ///< preset name
  std::uint64_t survey_version = 0;      ///< grows with every stored batch
  PublicationPolicy publication = PublicationPolicy::kAutomatic;
  bool operator==(const BuildingRecord&) const = default;
};

/// A transmitter as the survey heard it.
struct TransmitterRecord {
  Bssid bssid;
  std::uint16_t frequency_mhz = 0;
  std::uint64_t readings = 0;
  double strongest_dbm = 0.0;
};

struct StoredPoint {
  std::uint64_t id = 0;
  ReferencePoint point;
};

/// What a page of stored points is asked by.
struct PointQuery {
  std::optional<FloorOrdinal> floor;
  std::uint64_t after_id = 0;            ///< exclusive
  std::uint32_t most = 1000;
  std::optional<std::uint64_t> through_version = {};  ///< only what the survey held at that version (but for what was erased)
};

/// A survey batch that is stored.
struct UploadRecord {
  std::uint64_t id = 0;
  std::string idempotency_key;
  std::uint64_t points = 0;              ///< that it brought; some may be erased since
  std::uint64_t survey_version = 0;      ///< that it made
};

/// Which points to take out: all that fit every condition given. None given = no point at all.
struct EraseQuery {
  std::optional<std::uint64_t> point_id = {};
  std::optional<std::string> walk = {};
  std::optional<std::string> device_model = {};
  std::optional<std::string> idempotency_key = {};   ///< of the upload that brought them
  std::optional<UnixTime> surveyed_before = {};      ///< retention
};

/// What verify() read, and everything it found wrong in words.
struct VerifyReport {
  std::uint64_t uploads = 0;
  std::uint64_t uploads_proven = 0;      ///< whole and equal to their body hash; the others had points erased
  std::uint64_t points = 0;
  std::uint64_t scans = 0;
  std::uint64_t readings = 0;
  std::uint64_t transmitters = 0;
  std::uint64_t contents = 0;            ///< radio maps and quality walks equal to their sha256
  std::vector<std::string> wrong;        ///< empty = sound
};

/// One building's SQLite file: WAL, synchronous=FULL, foreign keys, one writer process.
///
/// Every mutating call returns only after COMMIT is durable. Thread: confined to the store's writer thread (StoreWriter);
/// tests may own one directly. Faults: kStoreBusy, kStoreTooNew, kStoreCorrupt, kStorageFull, kStorageFailed.
class BuildingDatabase {
 public:
  struct OpenOptions {
    std::string vfs;                     ///< SQLite VFS name; empty = the default one
    bool synchronous_normal = false;     ///< only for the control experiment of the durability campaign
    int checkpoint_pages = 1000;         ///< pages of 4 KiB in the log before it is folded into the database
  };
  static Result<BuildingDatabase> create(const std::filesystem::path& file, const BuildingRecord& building, const OpenOptions& options);
  static Result<BuildingDatabase> open(const std::filesystem::path& file, const OpenOptions& options);
  BuildingDatabase(BuildingDatabase&&) noexcept;
  BuildingDatabase& operator=(BuildingDatabase&&) noexcept;
  ~BuildingDatabase();

  Result<BuildingRecord> building();
  Result<void> update(const BuildingRecord& building);    ///< all but id and survey_version

  /// Stores several batches in one transaction (group commit); one answer a batch, in order.
  /// Same key and body = the stored answer; same key, other body = kIdempotencyConflict for that batch alone.
  std::vector<Result<SurveyAck>> store(const std::vector<SurveyBatch>& batches);

  Result<std::vector<StoredPoint>> points(const PointQuery& query);
  Result<std::uint64_t> count_points();
  /// Batches with ids beyond `after`, ascending, at most `most`.
  Result<std::vector<UploadRecord>> uploads(std::uint64_t after, std::uint32_t most);
  Result<std::vector<TransmitterRecord>> transmitters();

  /// Keeps a part of a recorded walk; its scans are not among the points before they are placed. Faults: kIdempotencyConflict;
  /// kConflict when the walk has another part of that number, has ended, or came as placed points before.
  Result<SurveyAck> store_walk_part(const WalkPartDraft& part);
  /// Walks that are complete and not placed yet, oldest first; their parts' contents; and the word that they are placed.
  Result<std::vector<std::string>> walks_to_place();
  Result<std::vector<std::string>> walk_parts(const std::string& walk);
  Result<void> mark_placed(const std::string& walk);

  Result<std::vector<AccessPointRecord>> access_points();  ///< with a verdict or an operator's word; ascending
  Result<void> note_verdicts(const std::vector<AccessPointRecord>& verdicts);  ///< their `trust` is not looked at
  Result<void> set_trust(Bssid bssid, AccessPointTrust trust, UnixTime at);

  /// Takes points out for good, with their scans; what the survey heard is counted anew. The upload's row stays, so a retry
  /// does not bring them back. Answers how many went; the survey version grows if any did.
  Result<std::uint64_t> erase(const EraseQuery& query);

  /// Takes what was erased out of the log and of copies a migration left. False = a reader holds the log: try again later.
  Result<bool> scrub();

  Result<std::vector<ZoneRecord>> zones();               ///< ascending ids
  /// Id 0 = a new one; else replaces, kNotFound if there is none.
  Result<ZoneRecord> put_zone(const ZoneRecord& zone);
  Result<void> remove_zone(std::uint64_t id);

  Result<std::vector<WebhookRecord>> webhooks();         ///< ascending ids
  /// Id 0 = a new one; else replaces all but secret and creation, kNotFound if there is none.
  Result<WebhookRecord> put_webhook(const WebhookRecord& webhook);
  Result<void> remove_webhook(std::uint64_t id);

  Result<void> put_floor_image(const FloorImage& image); ///< replaces
  Result<FloorImage> floor_image(FloorOrdinal floor);    ///< kNotFound if there is none
  Result<std::vector<FloorOrdinal>> floor_images();      ///< floors that have one, ascending
  Result<void> remove_floor_image(FloorOrdinal floor);

  /// Keeps a radio map for good; the same content again is the same version. A new version is above all before it and not below
  /// its survey's version.
  Result<RadioMapRecord> stage_map(const RadioMapDraft& draft);
  Result<std::vector<RadioMapRecord>> maps();            ///< ascending versions
  Result<std::string> map_content(std::uint64_t version);  ///< checked against its sha256
  /// Only one that was never published; kConflict otherwise.
  Result<void> discard_map(std::uint64_t version);
  Result<std::optional<std::uint64_t>> live_map();
  Result<std::vector<Publication>> publications();       ///< oldest first
  /// Puts `publication.version` in force; kConflict when another version than `expected_live` is live by now.
  Result<Publication> promote(const Publication& publication, std::optional<std::uint64_t> expected_live);
  /// Back to what was live before the live version was promoted; kConflict when nothing was. The version given is ignored.
  Result<Publication> roll_back(const Publication& publication);

  /// The same content again is the same walk; kConflict when another walk has that name.
  Result<QualityWalkRecord> add_quality_walk(const QualityWalkDraft& draft);
  Result<std::vector<QualityWalkRecord>> quality_walks();
  Result<std::string> quality_walk_content(std::uint64_t id);
  Result<void> remove_quality_walk(std::uint64_t id);    ///< with what was measured by it
  /// Replaces what this map measured on this walk before.
  Result<void> note_quality(const MapQuality& quality);
  Result<std::vector<MapQuality>> qualities(std::uint64_t version);

  /// What that pipeline learnt last; absent: nothing, or nothing kept.
  Result<std::optional<CorrectorRecord>> corrector(const std::string& pipeline);
  Result<void> keep_corrector(const CorrectorRecord& corrector);

  /// Reads everything and holds it against its hashes and counts: a flipped bit in a reading is found too.
  Result<VerifyReport> verify();
  /// SQLite's own backup into a new file, consistent while writers go on.
  Result<void> back_up_to(const std::filesystem::path& file);

  /// What an earlier call found wrong with the file itself: kStoreCorrupt. The owner should put the file aside.
  const std::optional<Fault>& corruption() const;

 private:
  struct Connection;
  explicit BuildingDatabase(std::unique_ptr<Connection> connection);
  std::unique_ptr<Connection> connection_;
};

}  // namespace wayfuse
