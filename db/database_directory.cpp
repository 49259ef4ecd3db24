#include "db/database_directory.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "db/directory_files.hpp"
#include "db/server_database.hpp"
#include "db/writer_queue.hpp"

namespace wayfuse {
namespace {

Fault closed() { return {FaultCode::kDraining, "", "the store is closed"}; }

bool passes_by_itself(FaultCode code) {
  return code == FaultCode::kStorageFull || code == FaultCode::kStorageFailed || code == FaultCode::kStoreBusy;
}

class DirectoryOnDisk final : public DatabaseDirectory {
 public:
  DirectoryOnDisk(const std::filesystem::path& folder, const Options& options)
      : folder_(folder),
        options_(options),
        found_(list_or_make(folder)),
        server_(folder, ConnectionSettings{.vfs = options.vfs}),
        queue_({options.own_thread, options.gather_for, options.group_points, options.most_waiting_points},
               [this](BuildingId id, std::vector<PendingUpload> group) { commit(id, std::move(group)); }) {
    queue_.call([this] { open_all(); });
  }

  ~DirectoryOnDisk() override { close(); }

  void with_building(BuildingId id, std::function<void(Result<BuildingDatabase*>)> task) override {
    const bool taken = queue_.post(id, [this, id, task] {
      task(find(id));
      put_aside_if_corrupt(id);
    });
    if (!taken) task(closed());
  }

  void store(BuildingId id, SurveyBatch batch, std::function<void(Result<SurveyAck>)> done) override {
    PendingUpload upload{id, std::move(batch), std::move(done)};
    if (!queue_.upload(upload)) upload.done(closed());
  }

  void create_building(BuildingRecord building, std::function<void(Result<BuildingRecord>)> done) override {
    if (!queue_.post(std::nullopt, [this, building = std::move(building), done] { done(create(building)); })) done(closed());
  }

  void restore_building(std::filesystem::path backup, std::function<void(Result<BuildingRecord>)> done) override {
    if (!queue_.post(std::nullopt, [this, backup = std::move(backup), done] { done(restore(backup)); })) done(closed());
  }

  void remove_building(BuildingId id, UnixTime at, std::function<void(Result<void>)> done) override {
    if (!queue_.post(std::nullopt, [this, id, at, done] { done(remove(id, at)); })) done(closed());
  }

  std::filesystem::path passing_file() override { return wayfuse::passing_file(folder_, ++passing_); }

  std::vector<BuildingId> buildings() const override {
    const std::lock_guard lock(mutex_);
    return present_;
  }

  std::vector<std::pair<BuildingId, Fault>> quarantined() const override {
    const std::lock_guard lock(mutex_);
    return {unusable_.begin(), unusable_.end()};
  }

  Result<std::string> server_secret() override {
    return on_writer<std::string>([this] { return server_.secret(); });
  }
  Result<std::vector<KeyRecord>> keys() override {
    return on_writer<std::vector<KeyRecord>>([this] { return server_.keys(); });
  }
  Result<KeyRecord> add_key(KeyRecord key) override {
    return on_writer<KeyRecord>([&] { return server_.add_key(std::move(key)); });
  }
  Result<void> revoke_key(std::uint64_t id) override {
    return on_writer<void>([&] { return server_.revoke_key(id); });
  }

  void audit(AuditRecord record, std::function<void(Result<void>)> done) override {
    {
      const std::lock_guard lock(mutex_);
      audit_waiting_.push_back({std::move(record), std::move(done)});
      if (audit_waiting_.size() > 1) return;  // the task of the first takes all
    }
    if (queue_.post(std::nullopt, [this] { write_waiting_audit(); })) return;
    std::vector<WaitingAudit> refused;
    {
      const std::lock_guard lock(mutex_);
      refused.swap(audit_waiting_);
    }
    for (const WaitingAudit& entry : refused) entry.done(closed());
  }
  Result<std::vector<AuditRecord>> audited(const AuditQuery& query) override {
    return on_writer<std::vector<AuditRecord>>([&] { return server_.audited(query); });
  }
  Result<std::uint64_t> forget_audit(UnixTime before) override {
    return on_writer<std::uint64_t>([&] { return server_.forget_audit(before); });
  }

  void note_upkeep(UpkeepRecord record, std::function<void(Result<void>)> done) override {
    if (!queue_.post(std::nullopt, [this, record, done] { done(server_.note_upkeep(record)); })) done(closed());
  }
  Result<std::vector<UpkeepRecord>> upkeep(BuildingId building) override {
    return on_writer<std::vector<UpkeepRecord>>([&] { return server_.upkeep(building); });
  }

  void note_answered(std::string name, std::optional<AnsweredPost> record, UnixTime oldest, std::function<void(Result<void>)> done) override {
    const auto change = std::make_shared<AnsweredPostChange>(AnsweredPostChange{std::move(name), std::move(record)});
    if (!queue_.post(std::nullopt, [this, change, oldest, done] { done(server_.note_answered({*change}, oldest)); })) done(closed());
  }
  Result<std::vector<AnsweredPost>> answered_posts() override {
    return on_writer<std::vector<AnsweredPost>>([&] { return server_.answered_posts(); });
  }

  void close() override {
    queue_.stop();
    databases_.clear();  // the last connection to a database checkpoints its log
  }

 private:
  struct WaitingAudit {
    AuditRecord record;
    std::function<void(Result<void>)> done;
  };

  void write_waiting_audit() {
    std::vector<WaitingAudit> waiting;
    {
      const std::lock_guard lock(mutex_);
      waiting.swap(audit_waiting_);
    }
    std::vector<AuditRecord> records;
    for (const WaitingAudit& entry : waiting) records.push_back(entry.record);
    const Result<void> all = server_.audit(records);
    // One line that breaks a rule must not silence the others.
    for (const WaitingAudit& entry : waiting) entry.done(all || waiting.size() == 1 ? all : server_.audit({entry.record}));
  }

  template <typename T>
  Result<T> on_writer(const std::function<Result<T>()>& task) {
    std::optional<Result<T>> answer;
    if (!queue_.call([&] { answer.emplace(task()); })) return closed();
    return std::move(*answer);
  }

  void open_all() {
    remove_passing_files(folder_);
    for (const BuildingId id : found_.corrupt) {
      mark_unusable(id, {FaultCode::kStoreCorrupt, building_file(folder_, id).filename().string(), "put aside at an earlier start"});
    }
    for (const BuildingId id : found_.buildings) open(id);
  }

  void open(BuildingId id) {
    Result<BuildingDatabase> opened = BuildingDatabase::open(building_file(folder_, id), {.vfs = options_.vfs});
    if (opened) {
      databases_.insert_or_assign(id, std::move(*opened));
      return mark_usable(id);
    }
    if (opened.fault().code == FaultCode::kNotFound) {
      const Result<void> removed = as_result([&] { remove_database(building_file(folder_, id)); });
      return removed ? forget(id) : mark_unusable(id, removed.fault());
    }
    if (opened.fault().code == FaultCode::kStoreCorrupt) return put_aside(id, opened.fault());
    mark_unusable(id, opened.fault());
  }

  Result<BuildingDatabase*> find(BuildingId id) {
    const auto open_already = databases_.find(id);
    if (open_already != databases_.end()) return &open_already->second;
    std::optional<Fault> fault = why_unusable(id);
    if (fault && passes_by_itself(fault->code)) {
      open(id);
      if (const auto now = databases_.find(id); now != databases_.end()) return &now->second;
      fault = why_unusable(id);
    }
    if (fault) return *fault;
    return Fault{FaultCode::kUnknownBuilding, "building", "there is no building " + std::to_string(id.value)};
  }

  Result<BuildingRecord> create(BuildingRecord building) {
    if (building.id.value == 0) {
      const Result<BuildingId> removed = server_.highest_removed();
      if (!removed) return removed.fault();
      building.id = std::max(next_id(), BuildingId{removed->value + 1});
    }
    if (databases_.count(building.id) != 0 || why_unusable(building.id)) {
      return Fault{FaultCode::kConflict, "id", "there is a building " + std::to_string(building.id.value) + " already"};
    }
    building.survey_version = 0;
    Result<BuildingDatabase> made = BuildingDatabase::create(building_file(folder_, building.id), building, {.vfs = options_.vfs});
    if (!made) {
      // What was begun holds nothing yet; a next attempt under the same number must find the place free.
      if (made.fault().code != FaultCode::kConflict) (void)as_result([&] { remove_database(building_file(folder_, building.id)); });
      return made.fault();
    }
    databases_.insert_or_assign(building.id, std::move(*made));
    mark_usable(building.id);
    return building;
  }

  // The number is noted first: a crash in between leaves a building that is still there, never a number that comes back.
  Result<void> remove(BuildingId id, UnixTime at) {
    if (databases_.count(id) == 0 && !why_unusable(id)) {
      return Fault{FaultCode::kUnknownBuilding, "building", "there is no building " + std::to_string(id.value)};
    }
    if (const Result<void> noted = server_.note_removed(id, at); !noted) return noted;
    databases_.erase(id);
    const Result<void> removed = as_result([&] { remove_building_files(folder_, id); });
    if (removed) {
      forget(id);
    } else {
      mark_unusable(id, removed.fault());
    }
    return removed;
  }

  Result<BuildingRecord> restore(const std::filesystem::path& backup) {
    const std::filesystem::path place = folder_ / "restoring.sqlite";
    Result<BuildingRecord> building = sound_copy(backup, place);
    if (building && databases_.count(building->id) != 0) {
      building = Fault{FaultCode::kConflict, "id", "building " + std::to_string(building->id.value) + " is in use"};
    }
    const Result<void> placed = as_result([&] {
      if (building) put_in_place(folder_, place, building->id);
      remove_database(place);
    });
    if (!building) return building;
    if (!placed) return placed.fault();
    open(building->id);
    if (const std::optional<Fault> fault = why_unusable(building->id)) return *fault;
    return building;
  }

  // A copy of a backup at `place`, brought to today's schema and read from end to end.
  Result<BuildingRecord> sound_copy(const std::filesystem::path& backup, const std::filesystem::path& place) {
    const Result<void> copied = as_result([&] {
      remove_database(place);
      SqliteConnection(backup, options_.vfs, SqliteConnection::Mode::kReadOnly).back_up_to(place, options_.vfs);
    });
    if (!copied) return copied.fault();
    Result<BuildingDatabase> opened = BuildingDatabase::open(place, {.vfs = options_.vfs});
    if (!opened) return opened.fault();
    const Result<VerifyReport> report = opened->verify();
    if (!report) return report.fault();
    if (!report->wrong.empty()) return Fault{FaultCode::kStoreCorrupt, backup.filename().string(), report->wrong.front()};
    return opened->building();
  }

  void commit(BuildingId id, std::vector<PendingUpload> group) {
    const Result<BuildingDatabase*> database = find(id);
    std::vector<Result<SurveyAck>> answers;
    if (database) {
      std::vector<SurveyBatch> batches;
      batches.reserve(group.size());
      for (PendingUpload& upload : group) batches.push_back(std::move(upload.batch));
      answers = (*database)->store(batches);
    } else {
      answers.assign(group.size(), database.fault());
    }
    put_aside_if_corrupt(id);
    for (std::size_t i = 0; i < group.size(); ++i) group[i].done(std::move(answers[i]));
  }

  void put_aside_if_corrupt(BuildingId id) {
    const auto found = databases_.find(id);
    if (found == databases_.end() || !found->second.corruption()) return;
    const Fault fault = *found->second.corruption();
    databases_.erase(found);
    put_aside(id, fault);
  }

  void put_aside(BuildingId id, const Fault& fault) {
    const Result<void> moved = as_result([&] { wayfuse::put_aside(folder_, id); });
    mark_unusable(id, moved ? fault : Fault{fault.code, fault.field, fault.cause + "; and could not be put aside: " + moved.fault().cause});
  }

  BuildingId next_id() const {
    const std::lock_guard lock(mutex_);
    const std::uint64_t opened = present_.empty() ? 0 : present_.back().value;
    return {std::max(opened, unusable_.empty() ? 0 : unusable_.rbegin()->first.value) + 1};
  }

  std::optional<Fault> why_unusable(BuildingId id) const {
    const std::lock_guard lock(mutex_);
    const auto found = unusable_.find(id);
    return found == unusable_.end() ? std::nullopt : std::optional(found->second);
  }

  void mark_usable(BuildingId id) {
    const std::lock_guard lock(mutex_);
    unusable_.erase(id);
    const auto place = std::lower_bound(present_.begin(), present_.end(), id);
    if (place == present_.end() || *place != id) present_.insert(place, id);
  }
  void mark_unusable(BuildingId id, const Fault& fault) {
    const std::lock_guard lock(mutex_);
    unusable_.insert_or_assign(id, fault);
    std::erase(present_, id);
  }
  void forget(BuildingId id) {
    const std::lock_guard lock(mutex_);
    unusable_.erase(id);
    std::erase(present_, id);
  }

  const std::filesystem::path folder_;
  const Options options_;
  const DirectoryFiles found_;
  // Of the writer thread alone:
  ServerDatabase server_;
  std::map<BuildingId, BuildingDatabase> databases_;
  // Shared, never held while calling out:
  mutable std::mutex mutex_;
  std::vector<BuildingId> present_;              // ascending
  std::map<BuildingId, Fault> unusable_;
  std::vector<WaitingAudit> audit_waiting_;
  std::atomic<std::uint64_t> passing_{0};
  WriterQueue queue_;                            // last: its thread uses all the rest
};

}  // namespace

Result<std::unique_ptr<DatabaseDirectory>> DatabaseDirectory::open(const std::filesystem::path& folder, const Options& options) {
  return as_result([&]() -> std::unique_ptr<DatabaseDirectory> { return std::make_unique<DirectoryOnDisk>(folder, options); });
}

}  // namespace wayfuse
