#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {

/// Tests of readers: files written into a folder of their own.
class WrittenFiles : public testing::Test {
 protected:
  /// The file's whole path; folders on the way are made.
  std::string write(const std::string& name, const std::string& text) {
    const std::filesystem::path file = folder_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }

 private:
  const ScratchFolder scratch_;

 protected:
  const std::filesystem::path folder_ = scratch_.path();
};

}  // namespace wayfuse
