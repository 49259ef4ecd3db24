#pragma once

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/simulation/simulated_network.hpp"

namespace wayfuse {

/// Writes down what went over the wires and what it must have meant, by itself: neither the client nor the server is asked.
class Ledger final : public FrameWitness {
 public:
  struct Session {
    std::uint64_t begins_after = 0;
    BuildingId building;
    std::string tracked;
    std::map<std::uint64_t, SampleBody> samples;  ///< by number, as first heard
    std::vector<Position> positions;
    std::uint64_t acked = 0;
  };

  void server_heard(std::uint64_t connection, const ClientMessage& message) override;
  void server_said(std::uint64_t connection, const ServerMessage& message) override;
  void frame_arrived(PhoneTime at, std::string_view frame) override;

  const std::map<std::string, Session>& sessions() const { return sessions_; }
  std::uint64_t not_recovered() const { return not_recovered_; }
  std::uint64_t recovered() const { return recovered_; }
  std::uint64_t hash() const { return hash_; }

 private:
  void mix(const void* data, std::size_t size);

  std::map<std::uint64_t, std::string> session_of_;  ///< connection -> session
  std::map<std::uint64_t, bool> resuming_;
  std::map<std::string, Session> sessions_;
  std::uint64_t not_recovered_ = 0;
  std::uint64_t recovered_ = 0;
  std::uint64_t hash_ = 14695981039346656037ull;  ///< FNV-1a over every frame that arrived, and when
};

}  // namespace wayfuse
