#include "tests/simulation/ledger.hpp"

namespace wayfuse {

void Ledger::server_heard(std::uint64_t connection, const ClientMessage& message) {
  if (const auto* hello = std::get_if<Hello>(&message)) resuming_[connection] = hello->resume.has_value();
  const auto* batch = std::get_if<SampleBatch>(&message);
  if (!batch || !session_of_.contains(connection)) return;
  Session& session = sessions_.at(session_of_.at(connection));
  for (const Sample& sample : batch->samples) {
    const auto [known, fresh] = session.samples.emplace(sample.sequence, sample.body);
    if (!fresh) {
      EXPECT_TRUE(known->second == sample.body) << "sample " << sample.sequence << " came again with another body";
    }
  }
}

void Ledger::server_said(std::uint64_t connection, const ServerMessage& message) {
  if (const auto* welcome = std::get_if<Welcome>(&message); welcome && welcome->session.starts_with("session-")) {
    const bool first_on_connection = session_of_.emplace(connection, welcome->session).second;
    const auto [place, fresh] = sessions_.try_emplace(welcome->session);
    Session& session = place->second;
    if (fresh) session.begins_after = session.acked = welcome->applied_through;
    if (first_on_connection && resuming_[connection]) ++(welcome->recovered ? recovered_ : not_recovered_);
    if (first_on_connection) {
      EXPECT_EQ(fresh, !welcome->recovered);
    }
    EXPECT_GE(welcome->applied_through, session.acked);
    session.tracked = welcome->tracked;
    session.building = welcome->building;
    return;
  }
  const auto found = session_of_.find(connection);
  if (found == session_of_.end()) return;
  Session& session = sessions_.at(found->second);
  if (const auto* ack = std::get_if<Ack>(&message)) {
    EXPECT_GE(ack->through, session.acked) << "an acknowledgement went back";
    for (std::uint64_t number = session.acked + 1; number <= ack->through; ++number) {
      EXPECT_TRUE(session.samples.contains(number)) << "sample " << number << " was acknowledged and never heard";
    }
    session.acked = ack->through;
  }
  if (const auto* position = std::get_if<Position>(&message)) session.positions.push_back(*position);
}

void Ledger::frame_arrived(PhoneTime at, std::string_view frame) {
  const std::int64_t time_us = at.time_since_epoch().count();
  mix(&time_us, sizeof time_us);
  mix(frame.data(), frame.size());
}

void Ledger::mix(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211ull;
}

}  // namespace wayfuse
