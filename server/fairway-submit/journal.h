#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "core/result.h"
#include "proto/messages/json.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// A result that has its place in the folder.
struct KeptResult {
  std::string sha256;
  std::uint64_t bytes = 0;
};

/// What is known of one file of a batch.
struct JournalEntry {
  std::string payload;      ///< digest of all that is sent; another one is another entry
  int attempt = 1;          ///< jobs that are of no more use were begun before this one
  std::string server = {};  ///< where `job` lives, or that refused
  std::string job = {};     ///< empty: no job is known
  std::optional<KeptResult> result = {};
  std::optional<Json> problem = {};  ///< a failure that a new attempt would meet again
};

/// The account of a batch: lines of JSON that are only ever appended, each durable before its
/// consequence. Threads may share it, one file each.
///
///     {"batch":"<id>","version":1}
///     {"file":"a.glb","payload":"<digest>","attempt":1}                                begun
///     {"file":…, …, "server":"http://…","job":"<id>"}                                  accepted
///     {"file":…, …, "result":{"sha256":"…","bytes":1234}}                              in its
///     place
///     {"file":…, …, "problem":{…}}                                                     failed
class Journal {
 public:
  /// Reads it, or begins one with a new batch id. A last line that was cut short by a crash is
  /// dropped. Errors: usage (what is there is no such journal), io, storage_full.
  static Result<Journal> open(const std::filesystem::path& path);

  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&&) = delete;
  ~Journal() = default;

  /// Stays the same for all runs over a folder.
  const std::string& batch() const { return batch_; }
  /// True where this batch once had a result of that name, from whatever payload.
  bool wrote(const std::string& name) const;
  /// The entry of a file with this payload; a fresh one where it has none.
  JournalEntry entry(const std::string& name, const std::string& payload) const;
  /// Makes it the entry of the file, durably. Errors: io, storage_full.
  Result<void> put(const std::string& name, const JournalEntry& entry);

 private:
  explicit Journal(UniqueFd fd) : fd_(std::move(fd)) {}

  Result<void> read(const std::string& text);
  Result<void> read_line(const Json& line);
  Result<void> append(const Json& line);

  UniqueFd fd_;
  std::string batch_;

  mutable std::mutex mutex_;  ///< guards what follows, and the end of the file
  std::map<std::string, JournalEntry> entries_;
  std::map<std::string, bool> wrote_;
};

}  // namespace fairway
