#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace wayfuse {

/// One line on standard error that grows as the work is done; on a pipe or in a file a line every tenth instead.
///
/// Thread: any.
class ProgressBar {
 public:
  ProgressBar(std::string title, std::size_t total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  void advance(std::size_t done = 1);

 private:
  void draw(bool last);
  std::mutex mutex_;
  std::string title_;
  std::size_t total_;
  std::size_t done_ = 0;
  std::size_t drawn_ = 0;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace wayfuse
