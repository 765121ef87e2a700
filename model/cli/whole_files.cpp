#include "whole_files.hpp"

#include <fstream>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace fringe::cli {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& target) {
  throw std::runtime_error(fmt::format("{}: cannot be written", target.string()));
}

}  // namespace

Unfinished::Unfinished(fs::path path) : path_(std::move(path)) {}

Unfinished::~Unfinished() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

MissingFolders::MissingFolders(const fs::path& folder) {
  for (fs::path missing = folder; !missing.empty() && !fs::exists(missing); missing = missing.parent_path())
    made_ = missing;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw std::runtime_error(
        fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
}

MissingFolders::~MissingFolders() {
  std::error_code ignored;
  if (!made_.empty())
    fs::remove_all(made_, ignored);
}

fs::path unfinished_path(const fs::path& target) {
  return target.parent_path() / fmt::format(".{}.unfinished", target.filename().string());
}

void write_bytes(const fs::path& path, const std::string& bytes, const fs::path& target) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.close();
  if (!file)
    fail(target);
}

void rename_to(const fs::path& path, const fs::path& target) {
  std::error_code failure;
  fs::rename(path, target, failure);
  if (failure)
    fail(target);
}

void expect_writable(const fs::path& target) {
  const Unfinished trial(unfinished_path(target));
  write_bytes(trial.path(), "", target);
  // A folder in the place of a file would only be noticed when other files have been replaced.
  if (fs::is_directory(target))
    fail(target);
}

void write_whole(const std::map<fs::path, std::string>& files) {
  std::vector<std::unique_ptr<Unfinished>> written;
  for (const auto& [target, bytes] : files) {
    expect_writable(target);
    written.push_back(std::make_unique<Unfinished>(unfinished_path(target)));
    write_bytes(written.back()->path(), bytes, target);
  }
  auto unfinished = written.begin();
  for (const auto& [target, bytes] : files)
    rename_to((*unfinished++)->path(), target);
}

}  // namespace fringe::cli
