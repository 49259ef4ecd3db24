#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "db/building_database.hpp"

namespace wayfuse {

/// A survey batch on its way to the disk, and who waits for it.
struct PendingUpload {
  BuildingId building;
  SurveyBatch batch;
  std::function<void(Result<SurveyAck>)> done;
};

/// The one thread that touches the disk, and what waits for it, in order.
///
/// Uploads to one building are gathered into groups of at most `group_points` points. A group goes as soon as all who
/// uploaded lately are in it (a lone surveyor never waits), or when its first upload has waited `gather_for`.
/// Tasks keep their place behind the uploads of their building that came before them. Thread: any, but stop().
class WriterQueue {
 public:
  struct Settings {
    bool own_thread = true;              ///< false: everything runs at once on the caller's thread, in the call
    Duration gather_for = std::chrono::milliseconds(5);
    std::size_t group_points = 256;
    std::size_t most_points = 65'536;    ///< waiting; more is refused with kOverloaded
  };
  using Commit = std::function<void(BuildingId, std::vector<PendingUpload>)>;

  /// `commit` runs on the writer thread.
  WriterQueue(const Settings& settings, Commit commit);
  ~WriterQueue();

  /// False, and nothing done, after stop(); so for all three.
  bool post(std::optional<BuildingId> building, std::function<void()> task);
  bool upload(PendingUpload& upload);
  /// Runs `task` on the writer thread and waits for it; from the writer thread itself, at once.
  bool call(const std::function<void()>& task);
  /// Finishes what waits and joins.
  void stop();

 private:
  struct Entry {
    std::optional<BuildingId> building;  ///< of a task: absent = concerns all
    std::function<void()> task;          ///< empty = an upload
    PendingUpload upload;
  };
  void work();
  bool group_is_ready() const;
  std::vector<PendingUpload> take_group();
  bool on_writer_thread() const;
  bool stopped() const;

  const Settings settings_;
  const Commit commit_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Entry> entries_;
  std::size_t waiting_points_ = 0;
  std::size_t waiting_uploads_ = 0;
  std::size_t expected_uploads_ = 1;     ///< how many uploaded lately at the same time
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace wayfuse
