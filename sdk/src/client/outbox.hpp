#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// The ring of numbered samples that no server has acknowledged yet.
///
/// Two countings: the client's own, from 1 and never reset; and the wire's, which differs by a base only where a session had
/// to begin without resuming another after samples were gone (`wire = own - base`). Thread: confined to its client.
class Outbox {
 public:
  using Range = std::pair<std::uint64_t, std::uint64_t>;  ///< first..last, both inclusive

  Outbox(Duration keep, std::size_t bytes_most) : keep_(keep), bytes_most_(bytes_most) {}

  /// Numbers and keeps it. A report at rest that follows another one nobody has sent yet becomes one with it.
  std::uint64_t push(SampleBody body, PhoneTime now);
  /// Drops what is older than the ring or beyond its memory. What was never sent is lost for certain.
  void evict(PhoneTime now);
  void keep_for(Duration keep) { keep_ = keep; }
  /// While a server is asked and while it is given what it lacks, nothing is dropped for its age.
  void hold_still(bool still) { still_ = still; }

  /// For a resume: everything up to this wire number is no longer kept.
  std::uint64_t ask_resume() { return asked_ = first() - 1 - base_; }
  /// A session begins that resumes nothing: what is kept is numbered from 1, nothing of it is sent. What was sent before,
  /// dropped here and never acknowledged counts as lost.
  void begin_session();
  /// Answer to a resume: the whole session has applied all up to wire number `applied`, or a new one begins at `applied`.
  /// False = that cannot be true: never sent, or no longer kept.
  bool resume_session(bool whole, std::uint64_t applied);
  /// Cumulative acknowledgement of a wire number. False = it was never sent.
  bool acknowledge(std::uint64_t wire);

  /// Unsent samples as a batch of wire-numbered ones: at most `samples`, and about `bytes` when written as JSON.
  SampleBatch next(std::size_t samples, std::size_t bytes) const;
  void mark_sent(std::size_t samples);
  /// The last `samples` marked were not sent after all.
  void unsend(std::size_t samples) { sent_ = std::max(acked_, sent_ - samples); }
  /// All unacknowledged samples count as unsent again.
  void rewind() { sent_ = acked_; }

  /// Numbers are missing between what was sent and what is kept: only a new session can go on.
  bool broken() const { return first() > sent_ + 1; }
  bool nothing_on_the_way() const { return sent_ == acked_; }
  /// ... nor was there anything that a server left unanswered.
  bool all_acknowledged() const { return ever_sent_ == acked_; }
  bool has_unsent() const { return sent_ < last_; }
  /// Every unsent sample is a motion report at rest: nothing that hurries.
  bool only_rest_unsent() const;

  std::uint64_t last() const { return last_; }
  std::uint64_t acked() const { return acked_; }
  std::uint64_t own(std::uint64_t wire) const { return wire == 0 ? 0 : wire + base_; }
  std::size_t size() const { return kept_.size(); }
  std::size_t bytes() const { return bytes_; }

  /// The next range of numbers known to be lost, each told once.
  std::optional<Range> take_lost();

 private:
  struct Kept {
    std::uint64_t number = 0;
    SampleBody body;
    PhoneTime queued_at;
    std::size_t bytes = 0;
  };
  std::uint64_t first() const { return last_ + 1 - kept_.size(); }
  void pop();
  bool merge_rest(const SampleBody& body);
  void lose(std::uint64_t first, std::uint64_t last);

  Duration keep_;
  std::size_t bytes_most_;
  std::deque<Kept> kept_;  // consecutive numbers, the last is last_
  std::size_t bytes_ = 0;
  std::uint64_t last_ = 0;
  std::uint64_t base_ = 0;
  std::uint64_t asked_ = 0;      // wire number of the resume under way
  bool still_ = false;
  std::uint64_t acked_ = 0;      // own number; acked_ <= sent_ <= ever_sent_ <= last_
  std::uint64_t sent_ = 0;       // on this connection
  std::uint64_t ever_sent_ = 0;  // in this session
  std::deque<Range> lost_;
};

}  // namespace wayfuse
