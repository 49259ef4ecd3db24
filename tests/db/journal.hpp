#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/message.hpp"

/// What a client wrote down about its uploads, to be held against the database after a fault. One line each:
/// `sent KEY DIGEST...` before the upload (a digest a point), `acked KEY STORED VERSION` after the answer; each ends
/// in ` .`, for a kill may cut a line short where the next start ends it.
namespace wayfuse::testing {

/// 64-bit FNV-1a.
std::uint64_t fnv1a(std::string_view text);

/// One point, spelled with every bit of every field.
std::string spell(const ReferencePoint& point);

std::string sent_line(const SurveyBatch& batch);
std::string acked_line(const SurveyAck& ack);

struct JournalEntry {
  std::vector<std::uint64_t> digests;
  bool acked = false;
  std::uint64_t stored = 0;
  std::uint64_t survey_version = 0;
  bool answers_differ = false;   ///< two acks of one key that do not say the same
};
using Journal = std::map<std::string, JournalEntry>;  ///< by idempotency key

/// Adds a text's whole lines to `journal`.
void note(std::string_view text, Journal& journal);
/// The same with a file's text.
void read_journal(const std::filesystem::path& file, Journal& journal);

/// Everything that is wrong with a building's database, held against the journals of its only clients; empty = nothing was lost.
/// Reads by SQL of its own, without the store's code. `settled`: the clients have retried, so all that was sent must be there.
std::vector<std::string> find_losses(const std::filesystem::path& database, const Journal& journal, bool settled);

}  // namespace wayfuse::testing
