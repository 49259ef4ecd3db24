#include "db/answered_post_table.hpp"

namespace wayfuse {

void write_answered_posts(SqliteConnection& connection, std::span<const AnsweredPostChange> changes, UnixTime oldest) {
  Transaction transaction(connection);
  Statement put = connection.prepare("INSERT OR REPLACE INTO answered_post (name, body_hash, at_us, state, answer) VALUES (?, ?, ?, ?, ?)");
  Statement forget = connection.prepare("DELETE FROM answered_post WHERE name = ?");
  for (const AnsweredPostChange& change : changes) {
    if (!change.record) {
      forget.bind_text(1, change.name).run();
      continue;
    }
    const AnsweredPost& post = *change.record;
    put.bind_text(1, change.name).bind_text(2, post.body_hash).bind(3, std::int64_t{post.at.time_since_epoch().count()});
    put.bind(4, static_cast<std::int64_t>(post.state)).bind_blob(5, post.answer).run();
  }
  connection.prepare("DELETE FROM answered_post WHERE at_us < ?").bind(1, std::int64_t{oldest.time_since_epoch().count()}).run();
  transaction.commit();
}

std::vector<AnsweredPost> read_answered_posts(SqliteConnection& connection) {
  std::vector<AnsweredPost> posts;
  Statement select = connection.prepare("SELECT name, body_hash, at_us, state, answer FROM answered_post ORDER BY at_us");
  while (select.step()) {
    posts.push_back({std::string(select.text(0)), std::string(select.text(1)), UnixTime(Duration(select.integer(2))),
                     static_cast<AnsweredPost::State>(select.integer(3)), std::string(select.blob(4))});
  }
  return posts;
}

}  // namespace wayfuse
