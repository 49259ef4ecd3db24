#pragma once

#include <memory>
#include <string>

#include "tests/evaluation/walks/replay.hpp"
#include "tests/evaluation/walks/selection.hpp"

namespace wayfuse {

/// The same as SessionReplay with a real server: starts `wayfused` on a temporary folder and a free loopback port, surveys and
/// walks through real sockets. Samples keep the recording's times; the wall passes as fast as the machines can.
class SocketReplay final : public WalkReplay {
 public:
  /// `server` is the wayfused program. Throws std::runtime_error if it cannot be started.
  static Result<std::unique_ptr<SocketReplay>> create(const std::string& server, const RecordedSite& site,
                                                      const std::vector<RecordedWalk>& survey);
  ~SocketReplay() override;
  std::string_view path() const override { return "socket"; }
  Result<WalkReply> run(const RecordedWalk& walk, std::span<const Instant> instants, const std::string& pipeline,
                        std::uint64_t seed) const override;

 private:
  struct Server;
  explicit SocketReplay(std::unique_ptr<Server> server);
  std::unique_ptr<Server> server_;
};

}  // namespace wayfuse
