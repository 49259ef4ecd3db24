#include "db/writer_queue.hpp"

#include <algorithm>
#include <future>
#include <memory>

namespace wayfuse {

WriterQueue::WriterQueue(const Settings& settings, Commit commit) : settings_(settings), commit_(std::move(commit)) {
  if (settings_.own_thread) thread_ = std::thread([this] { work(); });
}

WriterQueue::~WriterQueue() { stop(); }

bool WriterQueue::on_writer_thread() const { return !settings_.own_thread || std::this_thread::get_id() == thread_.get_id(); }

bool WriterQueue::stopped() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

bool WriterQueue::post(std::optional<BuildingId> building, std::function<void()> task) {
  if (!settings_.own_thread) {
    if (stopped()) return false;
    task();
    return true;
  }
  {
    const std::lock_guard lock(mutex_);
    // What the writer's own callbacks post while it stops is still done: the thread leaves an empty queue only.
    if (stopping_ && !on_writer_thread()) return false;
    entries_.push_back({building, std::move(task), {}});
  }
  arrived_.notify_one();
  return true;
}

bool WriterQueue::upload(PendingUpload& upload) {
  if (!settings_.own_thread) {
    if (stopped()) return false;
    const BuildingId building = upload.building;
    std::vector<PendingUpload> group;
    group.push_back(std::move(upload));
    commit_(building, std::move(group));
    return true;
  }
  const std::size_t points = upload.batch.points.size();
  bool full = false;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_ && !on_writer_thread()) return false;
    full = waiting_points_ + points > settings_.most_points;
    if (!full) {
      waiting_points_ += points;
      ++waiting_uploads_;
      entries_.push_back({upload.building, {}, std::move(upload)});
    }
  }
  if (!full) {
    arrived_.notify_one();
    return true;
  }
  return post(std::nullopt, [done = std::move(upload.done), most = settings_.most_points] {
    done(Fault{FaultCode::kOverloaded, "points", std::to_string(most) + " points wait for the disk already"});
  });
}

bool WriterQueue::call(const std::function<void()>& task) {
  if (settings_.own_thread && on_writer_thread()) {
    task();
    return true;
  }
  const auto finished = std::make_shared<std::promise<void>>();
  const bool taken = post(std::nullopt, [&task, finished] {
    task();
    finished->set_value();
  });
  if (taken) finished->get_future().wait();
  return taken;
}

void WriterQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  arrived_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void WriterQueue::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    arrived_.wait(lock, [this] { return stopping_ || !entries_.empty(); });
    if (entries_.empty()) return;
    if (entries_.front().task) {
      const std::function<void()> task = std::move(entries_.front().task);
      entries_.pop_front();
      lock.unlock();
      task();
      lock.lock();
      continue;
    }
    const auto deadline = std::chrono::steady_clock::now() + settings_.gather_for;
    arrived_.wait_until(lock, deadline, [&] { return group_is_ready(); });
    std::vector<PendingUpload> group = take_group();
    const std::size_t committed = group.size();
    const BuildingId building = group.front().building;
    lock.unlock();
    commit_(building, std::move(group));
    lock.lock();
    // Who was committed now and who arrived meanwhile will probably come again together.
    expected_uploads_ = committed + waiting_uploads_;
  }
}

bool WriterQueue::group_is_ready() const {
  return stopping_ || waiting_uploads_ >= expected_uploads_ || waiting_points_ >= settings_.group_points ||
         waiting_uploads_ < entries_.size();  // a task waits behind it
}

std::vector<PendingUpload> WriterQueue::take_group() {
  std::vector<PendingUpload> group;
  const BuildingId building = entries_.front().upload.building;
  std::size_t points = 0;
  std::deque<Entry> rest;
  bool open = true;  // until a task of this building, or of all, or the group is full
  for (Entry& entry : entries_) {
    const bool task = static_cast<bool>(entry.task);
    const std::size_t size = entry.upload.batch.points.size();
    if (task && (!entry.building || *entry.building == building)) open = false;
    if (!task && entry.upload.building == building && !group.empty() && points + size > settings_.group_points) open = false;
    if (!open || task || entry.upload.building != building) {
      rest.push_back(std::move(entry));
      continue;
    }
    points += size;
    group.push_back(std::move(entry.upload));
  }
  entries_ = std::move(rest);
  waiting_points_ -= points;
  waiting_uploads_ -= group.size();
  return group;
}

}  // namespace wayfuse
