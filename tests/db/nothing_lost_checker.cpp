#include <cstdio>
#include <cstring>

#include "tests/db/journal.hpp"

// nothing_lost_checker [--settled] DATABASE JOURNAL...: exits 0 when nothing was lost, 1 with what was, 2 for wrong usage.
int main(int argc, char** argv) {
  using namespace wayfuse::testing;
  const bool settled = argc > 1 && std::strcmp(argv[1], "--settled") == 0;
  const int first = settled ? 2 : 1;
  if (argc <= first) {
    std::fprintf(stderr, "usage: nothing_lost_checker [--settled] DATABASE JOURNAL...\n");
    return 2;
  }
  Journal journal;
  for (int i = first + 1; i < argc; ++i) read_journal(argv[i], journal);
  const std::vector<std::string> losses = find_losses(argv[first], journal, settled);
  for (const std::string& loss : losses) std::fprintf(stderr, "%s\n", loss.c_str());
  return losses.empty() ? 0 : 1;
}
