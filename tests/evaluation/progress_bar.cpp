#include "tests/evaluation/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace wayfuse {

ProgressBar::ProgressBar(std::string title, std::size_t total)
    : title_(std::move(title)), total_(total), terminal_(isatty(STDERR_FILENO) != 0), begin_(std::chrono::steady_clock::now()) {
  draw(false);
}

ProgressBar::~ProgressBar() {
  const std::lock_guard lock(mutex_);
  draw(true);
}

void ProgressBar::advance(std::size_t done) {
  const std::lock_guard lock(mutex_);
  done_ = std::min(total_, done_ + done);
  const std::size_t grain = terminal_ ? 200 : 10;
  if (total_ > 0 && (done_ - drawn_) * grain >= total_) draw(false);
}

void ProgressBar::draw(bool last) {
  drawn_ = done_;
  const double share = total_ == 0 ? 1.0 : static_cast<double>(done_) / static_cast<double>(total_);
  const double spent_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  const double left_s = share > 0.0 ? spent_s * (1.0 - share) / share : 0.0;
  if (!terminal_) {
    std::fprintf(stderr, "%s: %zu/%zu, %.0f s\n", title_.c_str(), done_, total_, spent_s);
    return;
  }
  constexpr int kWidth = 32;
  const int full = static_cast<int>(share * kWidth);
  std::string bar(static_cast<std::size_t>(full), '#');
  bar.resize(kWidth, '.');
  std::fprintf(stderr, "\r%-24s [%s] %zu/%zu  %.0f s, %.0f s left \x1b[K%s", title_.c_str(), bar.c_str(), done_, total_,
               spent_s, left_s, last ? "\n" : "");
}

}  // namespace wayfuse
