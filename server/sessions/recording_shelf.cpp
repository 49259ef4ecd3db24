#include "server/sessions/recording_shelf.hpp"

#include <algorithm>

namespace wayfuse {

Result<RecordingState> RecordingShelf::order(BuildingId building, const RecordingOrder& order) {
  const std::lock_guard lock(mutex_);
  std::size_t elsewhere = 0;
  for (const auto& [id, shelf] : shelves_) elsewhere += id != building && (on(shelf) || shelf.used > 0) ? shelf.order.bytes : 0;
  if (order.on_for > Duration{0} && elsewhere + order.bytes > kBytesMost) {
    return Fault{FaultCode::kOutOfRange, "bytes", "other buildings' recordings may take " + std::to_string(elsewhere) + " of the " +
                                                      std::to_string(kBytesMost) + " bytes there are for all"};
  }
  Shelf& shelf = shelves_[building];
  shelf.order = order;
  shelf.until.reset(), shelf.until_wall.reset();
  shelf.erased.clear(), shelf.not_recorded.clear();
  if (order.on_for > Duration{0}) shelf.until = clock_.now() + order.on_for, shelf.until_wall = clock_.wall_now() + order.on_for;
  make_room(building, shelf);
  note_activity();
  return state_of(building);
}

RecordingState RecordingShelf::state(BuildingId building) const {
  const std::lock_guard lock(mutex_);
  return state_of(building);
}

RecordingState RecordingShelf::state_of(BuildingId building) const {
  RecordingState state;
  const auto found = shelves_.find(building);
  const Shelf none;
  const Shelf& shelf = found != shelves_.end() ? found->second : none;
  if (on(shelf)) state.until = shelf.until_wall;
  state.bytes = shelf.order.bytes;
  state.kept = shelf.order.kept;
  state.tracked = shelf.order.tracked;
  state.pieces_dropped = shelf.pieces_dropped;
  state.not_recorded = shelf.not_recorded.size();
  state.bytes_used = static_cast<std::size_t>(std::max<std::int64_t>(0, shelf.used));
  state.recordings = static_cast<std::size_t>(
      std::ranges::count_if(sessions_, [&](const auto& item) { return item.second->building == building && item.second->tape.oldest_end(); }));
  return state;
}

std::vector<RecordingSummary> RecordingShelf::list(BuildingId building, std::uint64_t after, std::size_t most) const {
  const std::lock_guard lock(mutex_);
  std::vector<RecordingSummary> found;
  for (auto it = sessions_.upper_bound(after); it != sessions_.end() && found.size() < most; ++it) {
    if (it->second->building == building && it->second->tape.oldest_end()) found.push_back(summary_of(it->second));
  }
  return found;
}

std::shared_ptr<const RecordedSession> RecordingShelf::find(std::uint64_t id, BuildingId building) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  const bool here = found != sessions_.end() && (building.value == 0 || found->second->building == building) && found->second->tape.oldest_end();
  return here ? found->second : nullptr;
}

std::optional<RecordingSummary> RecordingShelf::summary(std::uint64_t id, BuildingId building) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  const bool here = found != sessions_.end() && (building.value == 0 || found->second->building == building) && found->second->tape.oldest_end();
  return here ? std::optional(summary_of(found->second)) : std::nullopt;
}

RecordingSummary RecordingShelf::summary_of(const std::shared_ptr<RecordedSession>& held) const {
  const RecordedSession& session = *held;
  RecordingSummary summary;
  summary.id = session.id, summary.building = session.building, summary.seed = session.seed, summary.epoch = epoch_;
  summary.tracked = session.tracked, summary.device_model = session.device_model, summary.app = session.app;
  const auto pieces = session.tape.pieces();
  summary.pieces_dropped = session.tape.dropped();
  summary.growing = !session.stopped && held.use_count() > 1;
  if (pieces.empty()) return summary;
  summary.from_the_start = pieces.front()->first;
  summary.begun_at = pieces.front()->begun_at;
  summary.ended_at = pieces.back()->ended_at;
  summary.first_map = pieces.front()->with.map_version;
  TrackedWith last = pieces.back()->with;
  for (const TapeEntry& entry : pieces.back()->entries) {
    if (const auto* begun = std::get_if<TapeBegun>(&entry)) last = begun->with;
    if (const auto* exchanged = std::get_if<TapeExchanged>(&entry)) last = exchanged->with;
  }
  summary.last_map = last.map_version;
  summary.pipeline = last.pipeline;
  for (const auto& piece : pieces) {
    summary.samples += piece->samples;
    summary.answers += piece->answers;
    summary.bytes += piece->bytes;
  }
  return summary;
}

bool RecordingShelf::erase(std::uint64_t id, BuildingId building) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end() || (building.value != 0 && found->second->building != building)) return false;
  forget(*found->second);
  sessions_.erase(found);
  return true;
}

std::size_t RecordingShelf::erase_all(BuildingId building, const std::string& tracked) {
  const std::lock_guard lock(mutex_);
  return std::erase_if(sessions_, [&](const auto& item) {
    RecordedSession& session = *item.second;
    if (session.building != building || (!tracked.empty() && session.tracked != tracked)) return false;
    forget(session);
    return true;
  });
}

void RecordingShelf::forget(RecordedSession& session) {
  Shelf& shelf = shelves_[session.building];
  shelf.erased.push_back(session.tracked);
  shelf.used -= static_cast<std::int64_t>(session.tape.bytes());
  session.stopped = true;
}

void RecordingShelf::sweep() {
  if (idle()) return;
  const std::lock_guard lock(mutex_);
  const UnixTime now = clock_.wall_now();
  for (auto& [_, shelf] : shelves_) shelf.writing = 0;
  for (const auto& [_, session] : sessions_) {
    Shelf& shelf = shelves_[session->building];
    if (!on(shelf) || session.use_count() == 1) session->stopped = true;  // the order or the session ended
    shelf.writing += !session->stopped;
    for (auto end = session->tape.oldest_end(); end && *end + shelf.order.kept < now; end = session->tape.oldest_end()) {
      shelf.used -= static_cast<std::int64_t>(session->tape.drop_oldest());
    }
  }
  std::erase_if(sessions_, [](const auto& item) { return !item.second->tape.oldest_end() && item.second.use_count() == 1; });
  note_activity();
}

// An order in force that means this phone.
bool RecordingShelf::wants(BuildingId building, const std::string& tracked) const {
  const auto found = shelves_.find(building);
  if (found == shelves_.end() || !on(found->second)) return false;
  const Shelf& shelf = found->second;
  const auto names = [&](const std::vector<std::string>& list) { return std::ranges::find(list, tracked) != list.end(); };
  return !names(shelf.erased) && (shelf.order.tracked.empty() || names(shelf.order.tracked));
}

bool RecordingShelf::records(const RecordedSession* present, BuildingId building, const std::string& tracked) const {
  const std::lock_guard lock(mutex_);
  if (!wants(building, tracked)) return false;
  if (present && !present->stopped && present->building == building) return true;
  const Shelf& shelf = shelves_.at(building);
  return shelf.writing < shelf.order.bytes / kSessionBytes;
}

std::shared_ptr<RecordedSession> RecordingShelf::tape_for(std::shared_ptr<RecordedSession> present, BuildingId building, const std::string& tracked,
                                                          const std::string& device_model, const std::string& app, std::uint64_t seed) {
  const std::lock_guard lock(mutex_);
  if (!wants(building, tracked)) return nullptr;
  if (present && !present->stopped && present->building == building) return present;
  Shelf& shelf = shelves_.at(building);
  if (shelf.writing >= shelf.order.bytes / kSessionBytes) {
    shelf.not_recorded.insert(tracked);
    return nullptr;
  }
  ++shelf.writing;
  shelf.not_recorded.erase(tracked);
  auto session = std::make_shared<RecordedSession>();
  session->id = ++newest_id_;
  session->building = building;
  session->tracked = tracked, session->device_model = device_model, session->app = app;
  session->seed = seed;
  sessions_[session->id] = session;
  return session;
}

std::shared_ptr<const BuildingRecord> RecordingShelf::description_of(const Building& building) {
  const std::lock_guard lock(mutex_);
  auto& known = shelves_[building.record().id].description;
  if (!known || !TrackedWith::same_description(*known, building.record())) known = building.shared_record();
  return known;
}

void RecordingShelf::grown(const RecordedSession& session, std::size_t bytes, bool new_piece) {
  const std::lock_guard lock(mutex_);
  Shelf& shelf = shelves_[session.building];
  if (!sessions_.contains(session.id)) return;  // erased meanwhile
  shelf.used += static_cast<std::int64_t>(bytes);
  make_room(session.building, shelf);
  while (new_piece && maps_held(session.building) > kMapsMost && drop_oldest(session.building, shelf)) {
  }
}

void RecordingShelf::make_room(BuildingId building, Shelf& shelf) {
  while (shelf.used > static_cast<std::int64_t>(shelf.order.bytes) && drop_oldest(building, shelf)) {
  }
}

bool RecordingShelf::drop_oldest(BuildingId building, Shelf& shelf) {
  RecordedSession* oldest = nullptr;
  std::optional<UnixTime> oldest_end;
  for (const auto& [_, session] : sessions_) {
    const auto end = session->building == building ? session->tape.oldest_end() : std::nullopt;
    if (end && (!oldest_end || *end < *oldest_end)) oldest = session.get(), oldest_end = end;
  }
  if (!oldest) return false;
  shelf.used -= static_cast<std::int64_t>(oldest->tape.drop_oldest());
  ++shelf.pieces_dropped;
  return true;
}

std::size_t RecordingShelf::maps_held(BuildingId building) const {
  std::set<std::weak_ptr<const Building>, std::owner_less<>> held;
  for (const auto& [_, session] : sessions_) {
    if (session->building != building) continue;
    for (const auto& piece : session->tape.pieces()) held.insert(piece->with.snapshot);
  }
  return held.size();
}

void RecordingShelf::note_activity() {
  active_ = !sessions_.empty() || std::ranges::any_of(shelves_, [&](const auto& item) { return on(item.second); });
}

}  // namespace wayfuse
